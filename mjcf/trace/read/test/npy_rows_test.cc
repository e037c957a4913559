// SPDX-License-Identifier: Apache-2.0
// The fixtures are NumPy 1.24's (Python 3.11), made by these lines:
//     import numpy as np, os
//     t = np.array([0.0, 0.5, 1.0]); q = np.array([[1.0, -2.0], [3.0, 4.5], [5.0, 1e-300]])
//     np.save('fortran.npy', np.asfortranarray(q, '>f4'))
//     np.save('fields.npy', np.array([(0.25, (1, 2), -3, 'abc'), (0.5, (4, 5), 6, 'd')], np.dtype(
//         [('t', '<f8'), ('q', '<f8', (2,)), ('n', '<i4'), ('name', 'S3')], align=True)))
//     np.save('numbers.npy', np.array([(-1,) * 20 + (200, True), (1.5,) * 20 + (3, False)], [(o + k,
//         o + k) for o in '<>' for k in 'i1 i2 i4 i8 f2 f4 f8 u2 u4 u8'.split()] + [('u1', 'u1'),
//         ('b1', '?')]))
//     np.save('objects.npy', np.array([1.5, 'x'], object))
#include "mjcf/trace/read/numpy/npy_rows.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "mjcf/trace/atomic_file.h"
#include "mjcf/trace/read/npy_writer.h"
#include "mjcf/trace/read/test/recording.h"

namespace tauext::test {
namespace {

using Names = std::vector<std::string>;

class Npy : public Recording {
 protected:
  // a file of version 1.0 with that header and data
  std::string with(const std::string& header, const std::string& data = "") const {
    return put("\x93NUMPY" + low_first(1, 2) + low_first(header.size(), 2) + header + data,
               "x.npy");
  }
  // beginning with the path
  std::string error_with(const std::string& header, const std::string& data = "") const {
    const std::string file = with(header, data);
    const std::string error = error_of([&] { rows_of(NpyRows(file)); });
    return error.substr(error.find(": ") + 2);
  }
  static std::string of(const std::string& type, const std::string& shape) {
    return "{'descr': " + type + ", 'fortran_order': False, 'shape': " + shape + "}";
  }
};

// the file of (2, 3) numbers 1 .. 6 that numpy.save writes
const std::string kSixNumbers =
    "\x93NUMPY\x01" + std::string(1, '\0') + "v" + std::string(1, '\0') +
    "{'descr': '<f8', 'fortran_order': False, 'shape': (2, 3), }" + std::string(58, ' ') + "\n" +
    bytes_of_hex(
        "00 00 00 00 00 00 f0 3f 00 00 00 00 00 00 00 40 00 00 00 00 00 00 08 40 "
        "00 00 00 00 00 00 10 40 00 00 00 00 00 00 14 40 00 00 00 00 00 00 18 40");

TEST_F(Npy, ColumnsOfAMatrixAreNumbered) {
  NpyRows rows(put(kSixNumbers, "x.npy"));
  EXPECT_EQ(rows.columns(), (Names{"1", "2", "3"}));
  SkippedRows skipped;
  std::vector<double> row;
  ASSERT_TRUE(rows.next(row, skipped));
  EXPECT_EQ(rows.number(), 1);
  EXPECT_EQ(row, (std::vector<double>{1, 2, 3}));
  ASSERT_TRUE(rows.next(row, skipped));
  EXPECT_EQ(rows.number(), 2);
  EXPECT_EQ(row, (std::vector<double>{4, 5, 6}));
  EXPECT_FALSE(rows.next(row, skipped));
}

TEST_F(Npy, FortranOrderAndTheOtherByteOrderAreRead) {
  NpyRows rows(fixture("fortran.npy"));
  EXPECT_EQ(rows.columns(), (Names{"1", "2"}));
  EXPECT_EQ(rows_of(std::move(rows)), (Rows{{1, -2}, {3, 4.5}, {5, 0}}));
}

TEST_F(Npy, FieldsOfAStructureNameTheColumnsAndTextIsNone) {
  NpyRows rows(fixture("fields.npy"));
  EXPECT_EQ(rows.columns(), (Names{"t", "q1", "q2", "n"}));
  EXPECT_EQ(rows_of(std::move(rows)), (Rows{{0.25, 1, 2, -3}, {0.5, 4, 5, 6}}));
}

TEST_F(Npy, EveryPlainNumberIsRead) {
  NpyRows rows(fixture("numbers.npy"));
  const std::vector<double> once = {-1, -1, -1,    -1,           -1,
                                    -1, -1, 65535, 4294967295.0, std::ldexp(1, 64)};
  std::vector<double> first = once, second = {1, 1, 1, 1, 1.5, 1.5, 1.5, 1, 1, 1};
  first.insert(first.end(), once.begin(), once.end());
  second.insert(second.end(), second.begin(), second.begin() + 10);
  first.insert(first.end(), {200, 1});
  second.insert(second.end(), {3, 0});
  EXPECT_EQ(rows.columns().size(), 22u);
  EXPECT_EQ(rows_of(std::move(rows)), (Rows{first, second}));
}

// IEEE 754's table of binary16
TEST_F(Npy, HalvesAreReadToTheirLastBit) {
  const std::string bits = bytes_of_hex("01 00 ff 03 00 04 ff 7b 00 7c 00 fc 00 80");
  const Rows r = rows_of(NpyRows(with(of("'<f2'", "(7,)"), bits)));
  EXPECT_EQ(r, (Rows{{std::ldexp(1, -24)},
                     {std::ldexp(1023, -24)},
                     {std::ldexp(1, -14)},
                     {65504},
                     {HUGE_VAL},
                     {-HUGE_VAL},
                     {-0.0}}));
  EXPECT_TRUE(std::isnan(rows_of(NpyRows(with(of("'<f2'", "(1,)"), bytes_of_hex("01 7c"))))[0][0]));
}

TEST_F(Npy, HeadersOfOtherVersionsAndSpellingsAreRead) {
  const std::string data = bytes_of_hex("01 02 03");
  const Rows want = {{1}, {2}, {3}};
  EXPECT_EQ(
      rows_of(NpyRows(with("{\"shape\":(3L,),\"descr\":\"|u1\",\"fortran_order\":True}", data))),
      want);
  for (const int version : {2, 3}) {
    const std::string header = of("[('\\'\xC3\xA9', '|u1')]", "(3,)");
    NpyRows rows(
        put("\x93NUMPY" + low_first(version, 2) + low_first(header.size(), 4) + header + data,
            "x.npy"));
    EXPECT_EQ(rows.columns(), (Names{"'\xC3\xA9"}));
    EXPECT_EQ(rows_of(std::move(rows)), want);
  }
}

TEST_F(Npy, ErrorsNameWhatIsWrong) {
  EXPECT_EQ(error_with(of("'<f8'", "(5,)"), "12345678"), "is cut off: 8 of 40 bytes");
  EXPECT_EQ(error_with(of("'<f8'", "(0,)"), "12345678"), "has 8 bytes more than its 0 rows");
  EXPECT_EQ(error_with(of("'<U6'", "(1,)")), "holds no numbers");
  EXPECT_EQ(error_with(of("'<c16'", "(1,)")), "holds '<c16', which is no plain number");
  const std::string broken = error_with(of("'<f4\n'", "(1,)"));
  EXPECT_EQ(broken.find('\n'), broken.npos) << broken;
  EXPECT_NE(broken.find("which is no plain number"), broken.npos) << broken;
  EXPECT_EQ(error_with(of("[('t', '<M8[ns]')]", "(1,)")),
            "holds '<M8[ns]', which are no seconds: (t - t[0]) / np.timedelta64(1, 's') are");
  EXPECT_EQ(error_with(of("'<f8'", "(1, 2, 3)")),
            "has 3 dimensions, where rows of numbers have 1 or 2");
  EXPECT_EQ(error_with(of("[('t', '<f8')]", "(1, 2)")),
            "has 2 dimensions, where rows of fields have 1");
  EXPECT_EQ(error_with(of("'<f8'", "()"), "12345678"),
            "has 0 dimensions, where rows of numbers have 1 or 2");
  EXPECT_EQ(error_with(of("[('t', '<f8'), ('t', '<f8')]", "(0,)")),
            "column 't' appears twice: save one of them by another name");
  EXPECT_EQ(error_with(of("[('t', [('x', '<f8')])]", "(0,)")),
            "its header has a structure in a structure, at '[('x', '<f8')])], 'fortran_ord'");
  EXPECT_EQ(error_of([&] { NpyRows x(fixture("objects.npy")); }),
            fixture("objects.npy") +
                ": holds Python objects, which are not read: save numbers (dtype=float)");
  const std::string none = put("t,q1\n0,0\n", "x.npy"), empty = put("", "y.npy");
  EXPECT_EQ(error_of([&] { NpyRows x(none); }),
            none + ": begins as neither a .npy nor a .npz does");
  EXPECT_EQ(error_of([&] { NpyRows x(empty); }), empty + ": is empty");
  EXPECT_EQ(error_of([&] { NpyRows x(path("z")); }), path("z") + ": No such file or directory");
  EXPECT_EQ(error_of([&] { NpyRows x(path("")); }), path("") + ": Is a directory");
}

TEST_F(Npy, NothingIsAllocatedByWhatAHeaderClaims) {
  EXPECT_EQ(error_with(of("'<f8'", "(0, 1000000000)")),
            "has 1000000000 columns, where 1 to 4096 can be read");
  EXPECT_EQ(error_with(of("'<f8'", "(1000000000, 0)")),
            "has 0 columns, where 1 to 4096 can be read");
  EXPECT_EQ(error_with(of("'<f8'", "(1000000000000, 4096)")),
            "is cut off: 0 of 32768000000000000 bytes");
  for (const char* type :
       {"'<f8'", "[('x', '<f8', (99999999999,))]", "[('x', '<f8', (99999, 99999))]",
        "[('x', '<f8', (4096,)), ('y', '<f8')]", "[('x', '|V1048577')]", "'|S99999999999999999999'",
        "[('x', '|V1048576'), ('y', '<f8')]", "[('x', '|V1048576', (2,))]", "'<f8", "'f'", "''",
        "[('x', '<f8'", "[('x'", "[(", "[", "((", "[('x', '<f8', ())", "[('x', '<f8', (0,))]"}) {
    EXPECT_NE(error_with(of(type, "(99999999999999,)")), "no error") << type;
  }
  const std::string long_header =
      put("\x93NUMPY" + low_first(2, 2) + low_first(0xFFFFFFFF, 4), "y.npy");
  EXPECT_EQ(error_of([&] { NpyRows x(long_header); }),
            long_header + ": has a header of 4294967295 bytes, of at most 65536");
}

TEST_F(Npy, ABeginningOfAFileIsRefusedWhereverItEnds) {
  for (const char* name : {"fortran.npy", "fields.npy", "numbers.npy"}) {
    EXPECT_EQ(beginnings_that_can_be_read<NpyRows>(get(fixture(name))), 0) << name;
  }
  EXPECT_EQ(beginnings_that_can_be_read<NpyRows>(kSixNumbers), 0);
}

TEST_F(Npy, AFileIsReadInManyBlocks) {
  constexpr int kRows = 20000;
  std::string c, f;
  for (int i = 0; i < 3 * kRows; ++i) c += low_first(static_cast<unsigned>(i), 4);
  for (int j = 0; j < 3; ++j) {
    for (int k = 0; k < kRows; ++k) f += low_first(static_cast<unsigned>(3 * k + j), 4);
  }
  std::string header = of("'<u4'", "(20000, 3)");
  const Rows a = rows_of(NpyRows(with(header, c)));
  const Rows b = rows_of(NpyRows(with(header.replace(header.find("False"), 5, "True"), f)));
  ASSERT_EQ(a.size(), std::size_t{kRows});
  EXPECT_EQ(a[kRows - 1], (std::vector<double>{59997, 59998, 59999}));
  EXPECT_EQ(a, b);
}

TEST_F(Npy, WritesWhatNumpyWrites) {
  const double numbers[] = {1, 2, 3, 4, 5, 6};
  const auto npy = [&](const NpyArray& array) {
    write_npz(path("x.npz"), {array});
    const std::string bytes = get(path("x.npz"));  // not compressed
    const std::size_t begin = bytes.find("\x93NUMPY");
    return bytes.substr(begin, bytes.find("PK\1\2") - begin);
  };
  EXPECT_EQ(npy({"x", numbers, 2, 3}), kSixNumbers);
  EXPECT_EQ(npy({"y", numbers, 6, 0}).substr(10, 57),
            "{'descr': '<f8', 'fortran_order': False, 'shape': (6,), }");
}

}  // namespace
}  // namespace tauext::test
