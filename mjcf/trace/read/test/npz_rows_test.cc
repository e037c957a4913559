// SPDX-License-Identifier: Apache-2.0
// The fixtures are NumPy 1.24's (Python 3.11), made by these lines:
//     import numpy as np, os
//     t = np.array([0.0, 0.5, 1.0]); q = np.array([[1.0, -2.0], [3.0, 4.5], [5.0, 1e-300]])
//     arrays = dict(t=t, q=q, qd=np.asfortranarray(q + 10), tau=np.array([[7], [-8], [9]], '>i2'),
//                   rate=1000.0, names=np.array(['a', 'b']))
//     np.savez('stored.npz', **arrays)
//     np.savez_compressed('packed.npz', **arrays)
//     np.savez(os.fdopen(1, 'wb'), **arrays)    # | cat > piped.npz, with data descriptors
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "mjcf/trace/read/npy_writer.h"
#include "mjcf/trace/read/numpy/npy_rows.h"
#include "mjcf/trace/read/test/recording.h"

namespace tauext::test {
namespace {

using Names = std::vector<std::string>;

// a .npy of that shape, of zeros, as numpy.save writes it but for the blanks
std::string npy(const std::string& shape, std::size_t numbers) {
  const std::string header = "{'descr': '<f8', 'fortran_order': False, 'shape': " + shape + ", }\n";
  return "\x93NUMPY" + low_first(1, 2) + low_first(header.size(), 2) + header +
         std::string(8 * numbers, '\0');
}

// CRC-32 of ISO 3309, bit by bit
std::uint32_t checksum(const std::string& bytes) {
  std::uint32_t c = 0xFFFFFFFF;
  for (const char b : bytes) {
    c ^= static_cast<unsigned char>(b);
    for (int i = 0; i < 8; ++i) c = c >> 1 ^ (c & 1 ? 0xEDB88320 : 0);
  }
  return ~c;
}

// a member of a ZIP as APPNOTE.TXT describes it
struct Member {
  std::string name, data;
  int flags = 0, method = 0;
  std::uint32_t size = 0;   // that the directory claims
  std::uint32_t wrong = 0;  // in its checksum

  std::string common() const {
    return low_first(20, 2) + low_first(flags, 2) + low_first(method, 2) + low_first(0, 4) +
           low_first(checksum(data) ^ wrong, 4) + low_first(data.size(), 4) + low_first(size, 4) +
           low_first(name.size(), 2) + low_first(0, 2);
  }
};

Member stored(const std::string& name, const std::string& data) {
  return {name + ".npy", data, 0, 0, static_cast<std::uint32_t>(data.size())};
}

std::string zip(const std::vector<Member>& members) {
  std::string all, directory;
  for (const Member& m : members) {
    directory += "PK\1\2" + low_first(20, 2) + m.common() + low_first(0, 10) +
                 low_first(all.size(), 4) + m.name;
    all += "PK\3\4" + m.common() + m.name + m.data;
  }
  const std::string count = low_first(members.size(), 2);
  return all + directory + "PK\5\6" + low_first(0, 4) + count + count +
         low_first(directory.size(), 4) + low_first(all.size(), 4) + low_first(0, 2);
}

class Npz : public Recording {
 protected:
  std::string error_of_reading(const std::string& bytes) const {
    const std::string file = put(bytes, "x.npz");
    const std::string error = error_of([&] { rows_of(NpyRows(file)); });
    EXPECT_EQ(error.find(file + ": "), 0u);
    return error.substr(error.find(": ") + 2);
  }
  static std::string changed(std::string bytes, std::size_t at, const std::string& by) {
    return bytes.replace(at, by.size(), by);
  }
};

TEST_F(Npz, ArraysAreColumnsSideBySide) {
  for (const char* name : {"stored.npz", "packed.npz", "piped.npz"}) {
    NpyRows rows(fixture(name));
    EXPECT_EQ(rows.columns(), (Names{"t", "q1", "q2", "qd1", "qd2", "tau1"})) << name;
    EXPECT_EQ(rows_of(std::move(rows)), (Rows{{0, 1, -2, 11, 8, 7},
                                              {0.5, 3, 4.5, 13, 14.5, -8},
                                              {1, 5, 1e-300, 15, 10 + 1e-300, 9}}))
        << name;
  }
}

// the member q.npy of CPython's zipfile with force_zip64, dated 1980-01-01
const std::string kLocal = bytes_of_hex(
    "50 4b 03 04 2d 00 00 00 00 00 00 00 21 00 39 71 09 da ff ff ff ff ff ff ff ff 05 "
    "00 14 00 71 2e 6e 70 79 01 00 10 00 b0 00 00 00 00 00 00 00 b0 00 00 00 00 00 00 "
    "00");
const std::string kQ = "\x93NUMPY\x01" + std::string(1, '\0') + "v" + std::string(1, '\0') +
                       "{'descr': '<f8', 'fortran_order': False, 'shape': (2, 3), }" +
                       std::string(58, ' ') + "\n" +
                       bytes_of_hex(
                           "00 00 00 00 00 00 f0 3f 00 00 00 00 00 00 00 40 "
                           "00 00 00 00 00 00 08 40 00 00 00 00 00 00 10 40 "
                           "00 00 00 00 00 00 14 40 00 00 00 00 00 00 18 40");
const std::string kEntry = bytes_of_hex(
    "50 4b 01 02 2d 03 2d 00 00 00 00 00 00 00 21 00 39 71 09 da b0 00 00 00 b0 00 00 "
    "00 05 00 00 00 00 00 00 00 00 00 00 00 80 01 00 00 00 00 71 2e 6e 70 79");
const std::string kEnd =
    bytes_of_hex("50 4b 05 06 00 00 00 00 01 00 01 00 33 00 00 00 e7 00 00 00 00 00");

TEST_F(Npz, AZipOfCPythonIsRead) {
  NpyRows rows(put(kLocal + kQ + kEntry + kEnd, "x.npz"));
  EXPECT_EQ(rows.columns(), (Names{"q1", "q2", "q3"}));
  EXPECT_EQ(rows_of(std::move(rows)), (Rows{{1, 2, 3}, {4, 5, 6}}));
  EXPECT_EQ(beginnings_that_can_be_read<NpyRows>(kLocal + kQ + kEntry + kEnd), 0);
}

// APPNOTE.TXT 4.3.14, 4.3.15 and 4.5.3
TEST_F(Npz, ADirectoryOf64BitsIsRead) {
  const std::string all(8, '\xFF');
  const std::string entry = changed(kEntry, 20, all).replace(30, 2, low_first(28, 2));
  const std::string wide = changed(entry, 42, low_first(0xFFFFFFFF, 4)) + low_first(1, 2) +
                           low_first(24, 2) + low_first(176, 8) + low_first(176, 8) +
                           low_first(0, 8);
  const std::string end64 = "PK\6\6" + low_first(44, 8) + low_first(45, 2) + low_first(45, 2) +
                            low_first(0, 8) + low_first(1, 8) + low_first(1, 8) +
                            low_first(wide.size(), 8) + low_first(0xe7, 8);
  const std::string locator =
      "PK\6\7" + low_first(0, 4) + low_first(0xe7 + wide.size(), 8) + low_first(1, 4);
  const std::string bytes = kLocal + kQ + wide + end64 + locator + changed(kEnd, 12, all);
  EXPECT_EQ(rows_of(NpyRows(put(bytes, "x.npz"))), (Rows{{1, 2, 3}, {4, 5, 6}}));
  EXPECT_EQ(beginnings_that_can_be_read<NpyRows>(bytes), 0);
  for (std::size_t at = kLocal.size() + kQ.size(); at < bytes.size(); ++at) {
    put(changed(bytes, at, "\xFE"), "y.npz");  // whatever becomes of it, it ends
    error_of([&] { rows_of(NpyRows(path("y.npz"))); });
  }
}

TEST_F(Npz, ABeginningOfAFileIsRefusedWhereverItEnds) {
  for (const char* name : {"stored.npz", "packed.npz", "piped.npz"}) {
    EXPECT_EQ(beginnings_that_can_be_read<NpyRows>(get(fixture(name))), 0) << name;
  }
}

TEST_F(Npz, NoByteOfAnArrayCanChangeUnseen) {
  for (const char* name : {"stored.npz", "packed.npz", "piped.npz"}) {
    const std::string bytes = get(fixture(name));
    const std::size_t end = bytes.find("rate.npy") - 30;  // which is not read
    int unseen = 0;
    for (std::size_t at = 0; at < end; ++at) {
      const std::string file =
          put(changed(bytes, at, std::string(1, static_cast<char>(bytes[at] ^ 0x10))), "x.npz");
      NpyRows intact(fixture(name));
      const Rows want = rows_of(std::move(intact));
      const std::string error = error_of([&] { unseen += rows_of(NpyRows(file)) == want ? 0 : 1; });
    }
    EXPECT_EQ(unseen, 0) << name;
  }
}

TEST_F(Npz, ErrorsNameTheArray) {
  const Member t = stored("t", npy("(3,)", 3));
  EXPECT_EQ(error_of_reading(zip({t, stored("q", npy("(4, 2)", 8)), stored("z", npy("(5,)", 5))})),
            "arrays that have not as many rows as 't' (3): 'q' (4), 'z' (5)");
  EXPECT_EQ(error_of_reading(zip({stored("q", npy("(4, 2)", 8)), t})),
            "arrays that have not as many rows as 't' (3): 'q' (4)");
  EXPECT_EQ(error_of_reading(zip({t, stored("q", npy("(3, 2)", 5))})),
            "array 'q': is cut off: 40 of 48 bytes");
  EXPECT_EQ(error_of_reading(zip({t, stored("q", npy("(3, 2)", 7))})),
            "array 'q': has 8 bytes more than its 3 rows");
  EXPECT_EQ(error_of_reading(zip({t, stored("q1", npy("(3,)", 3)), stored("q", npy("(3, 1)", 3))})),
            "column 'q1' appears twice: save one of them by another name");
  EXPECT_EQ(error_of_reading(zip({stored("rate", npy("()", 1))})),
            "has no array that could be columns");
  EXPECT_EQ(error_of_reading(zip({t, stored("\x1b[2J", "no array")})),
            "array '?[2J': begins as no NumPy array of version 1 to 3 does");
  EXPECT_EQ(error_of_reading(zip({t}).substr(0, 100)),
            "lacks the list of its arrays, which stands at its end: was it cut off? Copy it again");
  EXPECT_EQ(error_of_reading(zip({{"t.txt", "0", 0, 0, 1}})),
            "has 't.txt', which is no array of NumPy: unzip it first");
}

TEST_F(Npz, WhatADirectoryClaimsIsNotBelieved) {
  const std::string data = npy("(3,)", 3);
  const auto size = static_cast<std::uint32_t>(data.size());
  const auto refuses = [&](const Member& m) {
    return error_of_reading(zip({m})).find("array 't': cannot be unpacked: ") == 0;
  };
  EXPECT_TRUE(refuses({"t.npy", data, 1, 0, size}));   // encrypted
  EXPECT_TRUE(refuses({"t.npy", data, 0, 12, size}));  // by bzip2
  const std::string block =                            // as it is, and the last (RFC 1951)
      bytes_of_hex("01") + low_first(data.size(), 2) + low_first(~data.size() & 0xffff, 2) + data;
  EXPECT_TRUE(refuses({"t.npy", block, 0, 8, 4000000000}));  // of 4 GB
  // 07: a last block of a kind that is not there; 01 ..: one of 6 bytes as they are (RFC 1951)
  EXPECT_TRUE(refuses({"t.npy", bytes_of_hex("07"), 0, 8, 100}));
  EXPECT_TRUE(refuses({"t.npy", bytes_of_hex("01 06 00 f9 ff") + "\x93NUMPY", 0, 8, 100}));
  EXPECT_TRUE(refuses({"t.npy", data, 0, 0, size, 1}));  // another checksum
  for (const std::string& damaged :
       {changed(kLocal + kQ + kEntry + kEnd, 0xe7 + 42, "\x01"),
        changed(kLocal + kQ + kEntry + kEnd, 0xe7 + 28, "\xff"), kLocal + kQ})
    EXPECT_NE(error_of_reading(damaged), "no error");
}

TEST_F(Npz, OneColumnOfATimeIsATime) {
  NpyRows rows(put(zip({stored("t", npy("(3, 1)", 3)), stored("contact", npy("(3, 1)", 3)),
                        stored("q", npy("(3, 1)", 3))}),
                   "x.npz"));
  EXPECT_EQ(rows.columns(), (Names{"t", "contact", "q1"}));
}

TEST_F(Npz, WritesAnArrayThatZipAndNumpyDescribe) {
  const double t[] = {0, 0.5}, numbers[] = {1, 2, 3, 4, 5, 6};
  write_npz(path("x.npz"), {{"t", t, 2, 0}, {"q", numbers, 2, 3}});
  const std::string bytes = get(path("x.npz"));
  EXPECT_NE(bytes.find("PK\3\4" + low_first(20, 2)), bytes.npos);
  EXPECT_NE(bytes.find("q.npy" + kQ), bytes.npos);
  EXPECT_NE(bytes.find(low_first(0xda097139, 4) + low_first(176, 4)), bytes.npos);  // kLocal's
  NpyRows rows(path("x.npz"));
  EXPECT_EQ(rows.columns(), (Names{"t", "q1", "q2", "q3"}));
  EXPECT_EQ(rows_of(std::move(rows)), (Rows{{0, 1, 2, 3}, {0.5, 4, 5, 6}}));
  EXPECT_EQ(error_of([&] {
              write_npz(path("y.npz"), {{"q", nullptr, 1u << 30, 0}});
            }),
            path("y.npz") +
                ": a .npz of ours has at most 4 GiB and 65535 arrays: write a .mcap, or a .csv");
}

}  // namespace
}  // namespace tauext::test
