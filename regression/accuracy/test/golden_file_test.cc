// SPDX-License-Identifier: Apache-2.0
#include "regression/accuracy/golden_file.h"

#include <gtest/gtest.h>

#include <cmath>

#include "mjcf/test/error_of.h"

namespace tauext::gate {
namespace {

using tauext::test::error_of;

const char* const kText =
    "# tauext golden metrics 2\n# mujoco: 2.2.2\n# sensors: velocity_noise=0.001\n"
    "entry\tmetric\tseed 1\tseed 2\n"
    "r/s/e\tlag_s\t0.25\tnever\n# end\n";

TEST(GoldenFile, IsRead) {
  const Golden g = parse_golden(kText, "f");
  EXPECT_EQ(g.header.at("mujoco"), "2.2.2");
  EXPECT_EQ(g.seeds, (std::vector<std::string>{"seed 1", "seed 2"}));
  const GoldenLine& l = g.lines.at({"r/s/e", "lag_s"});
  EXPECT_EQ(l.values[0], 0.25);
  EXPECT_TRUE(std::isnan(l.values[1]));
}

TEST(GoldenFile, IsRefusedWithItsNameWheneverItIsNotWhole) {
  const std::string text = kText;
  for (std::size_t n = 0; n < text.size() - 1; ++n) {
    EXPECT_EQ(error_of([&] { parse_golden(text.substr(0, n), "file.tsv"); }).find("file.tsv: "), 0u)
        << n;
  }
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string bad = text;
    bad.replace(bad.find(from), from.size(), to);
    return error_of([&] { parse_golden(bad, "file.tsv"); });
  };
  EXPECT_NE(with("0.25", "0.2x").find("line 5: '0.2x' is no number"), std::string::npos);
  EXPECT_NE(with("0.25", "nan").find("is no number"), std::string::npos);
  EXPECT_NE(with("\tnever", "").find("3 columns, where 4 are named"), std::string::npos);
  EXPECT_NE(with("# end", "r/s/e\tlag_s\t1\t1\n# end").find("is there twice"), std::string::npos);
  EXPECT_NE(with("golden", "gilded").find("no golden metrics"), std::string::npos);
  EXPECT_NE(with("metrics 2", "metrics 1").find("of an older version: remove"), std::string::npos);
}

}  // namespace
}  // namespace tauext::gate
