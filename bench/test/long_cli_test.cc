// SPDX-License-Identifier: Apache-2.0
// Program runs that take minutes without optimisation: Release alone builds this file.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>

#include "bench/test/programs.h"

namespace tauext::test {
namespace {

TEST_F(Programs, DetectCalibratesThenStudiesWithThatFile) {
  const Outcome trained = run("tauext-detect --calibrate th.json --train known_0 --runs 1");
  ASSERT_EQ(trained.code, 0) << trained.text;
  const std::string small =
      " --conditions known_0 --estimator mo1 --detector contact_classifier --collisions 1 "
      "--hours 0 "
      "--pushes 0 --clampings 1";
  const Outcome study = run("tauext-detect --thresholds th.json --out study.json" + small);
  ASSERT_EQ(study.code, 0) << study.text;
  EXPECT_TRUE(study.says("mo1+contact_classifier")) << study.text;
  const auto json = nlohmann::json::parse(content("study.json"));
  EXPECT_EQ(json["cells"][0]["detector"], "contact_classifier");
  // the suite reads the file, too
  const Outcome suite =
      run("tauext-bench --thresholds th.json '--benchmark_filter=wallmobot3/clamp/mo1[+]'" +
          std::string(kQuick));
  EXPECT_EQ(suite.code, 0) << suite.text;
}

TEST_F(Programs, AStudyIsWrittenInTheFormatThatAProgramReads) {
  const Outcome o = run("tauext-bench --pareto --format json --out p.json");
  ASSERT_EQ(o.code, 0) << o.text;
  const auto json = nlohmann::json::parse(content("p.json"));
  EXPECT_EQ(json["format"], "tauext-pareto-1");
  ASSERT_GT(json["rows"].size(), 80u);
  for (const auto& point : json["rows"]) {
    EXPECT_EQ(point["settling_ms"].is_null(), point["verdict"] == "no value") << point;
  }
}

}  // namespace
}  // namespace tauext::test
