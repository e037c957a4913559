// SPDX-License-Identifier: Apache-2.0
// MATLAB's files. v5.mat and v5_struct.mat (compressed) were written by SciPy 1.10.1, v73.mat and
// v73_struct.mat by h5py 3.7.0 with the header and the attributes that MATLAB gives them.
#include "mjcf/trace/read/mat/mat_rows.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "mjcf/trace/read/recording.h"
#include "mjcf/trace/read/test/recording.h"

namespace tauext::test {
namespace {

using namespace std::string_literals;
using Names = std::vector<std::string>;

// 5 samples of 2 joints at j + t / 2 rad, with qd = -q, tau = 10 q
void expect_samples(const Trace& t) {
  ASSERT_EQ(t.size(), 5);
  ASSERT_EQ(t.dof(), 2);
  for (int k = 0; k < 5; ++k) {
    EXPECT_EQ(t.t[static_cast<std::size_t>(k)], 0.25 * k);
    for (int j = 0; j < 2; ++j) {
      const double q = j + 1 + k / 8.;
      EXPECT_EQ(t.q(j, k), q);
      EXPECT_EQ(t.qd(j, k), -q);
      EXPECT_EQ(t.tau(j, k), 10 * q);
    }
  }
}

class Mat : public Recording {
 protected:
  std::string error_of_reading(const std::string& file) const {
    const std::string error = error_of([&] { rows_of(MatRows(file)); });
    EXPECT_TRUE(error == "no error" || error.starts_with(file + ": ")) << error;
    EXPECT_EQ(error.find('\n'), std::string::npos);
    return error;
  }
};

// t of shape (n, 1), q of (n, 2), qd of (2, n), tau of single precision; a number and a text
TEST_F(Mat, VariablesAreColumnsHoweverTheyLie) {
  for (const char* name : {"v5.mat", "v73.mat"}) {
    SkippedRows skipped;
    expect_samples(read_recording(fixture(name), {}, &skipped));
    EXPECT_EQ(skipped.total(), 0) << name;
    EXPECT_EQ(skipped.notes, Names{}) << name;
    EXPECT_EQ(MatRows(fixture(name)).columns().size(), 7U) << name;
  }
}

TEST_F(Mat, FieldsOfAStructureAreCalledByTheirPath) {
  const std::string map =
      put("[t]\ncolumns = 'log\\.time'\n[q]\ncolumns = 'log\\.q(\\d)'\n"
          "[qd]\ncolumns = 'log\\.qd(\\d)'\n[tau]\ncolumns = 'log\\.tau(\\d)'\n",
          "log.toml");
  SkippedRows skipped;
  expect_samples(read_recording(fixture("v5_struct.mat"), {map, "", {}}, &skipped));
  EXPECT_EQ(skipped.notes,
            Names{"left out, being no real numbers in as many rows: c, who, log.gear (1 x 2), "
                  "B (7 x 7)"});
  EXPECT_EQ(MatRows(fixture("v5_struct.mat")).columns(),
            (Names{"log.time", "log.q1", "log.q2", "log.qd1", "log.qd2", "log.tau1", "log.tau2",
                   "log.inner.force1", "log.inner.force2", "log.inner.force3", "label"}));
  expect_samples(read_recording(fixture("v73_struct.mat"), {map, "", {}}, &skipped));
  EXPECT_EQ(skipped.notes, Names{"left out, being no real numbers in as many rows: B (7 x 7)"});
}

TEST_F(Mat, DamageIsAnErrorThatNamesTheFile) {
  const std::string kCompressed = "v5_struct.mat";  // which has checksums
  for (const std::string& name : {"v5.mat"s, kCompressed, "v73.mat"s}) {
    const std::string bytes = get(fixture(name));
    for (std::size_t n = 0; n < bytes.size(); n += n < 800 ? 13 : 400)
      EXPECT_NE(error_of_reading(put(bytes.substr(0, n), "cut.mat")), "no error") << name << n;
    for (std::size_t at = 128; at < bytes.size(); at += 61) {
      std::string changed = bytes;
      changed[at] = static_cast<char>(changed[at] ^ 0xff);
      const std::string error = error_of_reading(put(changed, "changed.mat"));
      EXPECT_TRUE(error != "no error" || name != kCompressed) << at;  // else it ends
    }
  }
}

}  // namespace
}  // namespace tauext::test
