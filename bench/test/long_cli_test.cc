// SPDX-License-Identifier: Apache-2.0
// Program runs that take minutes without optimisation: Release alone builds this file.
#include <fmt/format.h>
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

// what is of a date in a study
std::string undated(std::string json) {
  const std::size_t at = json.find("\"date\"");
  return at == json.npos ? json : json.erase(at, json.find('\n', at) - at);
}

TEST_F(Programs, AStudyInPartsIsTheWholeAndGoesOnAfterAKill) {
  ASSERT_EQ(run("tauext-detect --calibrate th.json --train known_0 --runs 1 --estimator mo1 "
                "--detector high_pass")
                .code,
            0);
  const std::string of =
      "tauext-detect --thresholds th.json --conditions known_0 --estimator mo1 --detector "
      "high_pass "
      "--collisions 60 --hours 0.1 --regions 1 --jobs ";
  ASSERT_EQ(run(of + "1 --out whole.json").code, 0);
  for (int i = 1; i <= 7; ++i) {
    const Outcome part = run(fmt::format("{}{} --shard {}/7 --out p{}.jsonl", of, 1 + i % 3, i, i));
    ASSERT_EQ(part.code, 0) << part.text;
  }
  // one was killed within its last line
  const std::string part3 = content("p3.jsonl");
  write("p3.jsonl", part3.substr(0, part3.size() - 20));
  EXPECT_EQ(run("tauext-detect merge p1.jsonl p2.jsonl p3.jsonl").code, 2);
  EXPECT_EQ(run(of + "2 --shard 3/7 --out p3.jsonl").code, 0);
  EXPECT_EQ(content("p3.jsonl"), part3);
  const Outcome merged = run(
      "tauext-detect merge p7.jsonl p2.jsonl p3.jsonl p1.jsonl p4.jsonl p5.jsonl p6.jsonl --out "
      "merged.json");
  ASSERT_EQ(merged.code, 0) << merged.text;
  EXPECT_EQ(undated(content("merged.json")), undated(content("whole.json")));
  EXPECT_EQ(run("tauext-detect merge p1.jsonl p1.jsonl").code, 2);
  EXPECT_TRUE(run(of + "1 --shard 8/7 --out x").says("--shard 8/7: I/N"));
  EXPECT_TRUE(run(of + "1 --shard 1/7").says("--shard needs --out FILE"));
}

TEST_F(Programs, TunesPairsIntoAFileThatAStudyTakes) {
  const std::string tune =
      "tauext-tune --robot wallmobot3 --conditions light --estimator mo1 --detector high_pass "
      "--evaluations 18 --out t.json";
  const Outcome tuned = run(tune);
  ASSERT_EQ(tuned.code, 0) << tuned.text;
  EXPECT_TRUE(run(tune).says("t.json: nothing was added"));
  const Outcome study =
      run("tauext-detect --thresholds t.json --collisions 8 --pushes 0 --clampings 0 --hours 0.1 "
          "--out s.json");
  ASSERT_EQ(study.code, 0) << study.text;
  const auto json = nlohmann::json::parse(content("s.json"));
  ASSERT_EQ(json["cells"].size(), 1u);
  EXPECT_EQ(json["cells"][0]["condition"], "light");
  const std::string detector = json["cells"][0]["detector"];
  EXPECT_EQ(detector.find("high_pass:w="), 0u) << detector;
  EXPECT_TRUE(run("tauext-tune --conditions light --tune w").says("one pair, not with"));
  EXPECT_TRUE(run("tauext-tune --conditions light").says("--conditions needs --out"));
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
