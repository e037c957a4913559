// SPDX-License-Identifier: Apache-2.0
#include "bench/tune/study_tuning.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "bench/roster/robots.h"
#include "bench/roster/threshold_file.h"
#include "mjcf/test/error_of.h"

namespace tauext::test {
namespace {

// wallmobot3 behind good sensors
StudyTuning small() {
  StudyTuning o;
  o.conditions = {"light"};
  o.estimators = {"mo1"};
  o.detectors = {"threshold", "high_pass", "contact_classifier"};
  o.evaluations = 18;
  o.free_runs = 4;
  o.meetings = 1;
  o.runs = 2;
  o.threads = 2;
  return o;
}

study::TunedStudy tuned(StudyTuning o, const std::vector<study::TunedRow>& known = {}) {
  study::TunedStudy all;
  o.found = [&](const study::TunedStudy& more) { append(more, all); };
  tune_study(o, known);
  return all;
}

const study::TunedStudy& tuned_once() {
  static const study::TunedStudy all = tuned(small());
  return all;
}

TEST(StudyTuning, GivesEachPairItsBudgetAndNothingGetsWorse) {
  ASSERT_EQ(tuned_once().rows.size(), 3u);
  bool better = false;
  for (const study::TunedRow& r : tuned_once().rows) {
    EXPECT_EQ(r.condition, "light");
    EXPECT_GE(r.recall, r.recall_before) << r.detector;
    EXPECT_LE(r.evaluations, 18) << r.detector;
    EXPECT_EQ(r.before.find("mo1+"), 0u);
    better = better || r.recall > r.recall_before;
    robot("wallmobot3").check(r.estimator, r.detector);  // or it throws
  }
  EXPECT_TRUE(better) << "a filter at 10 rad/s is not the best one";
  EXPECT_EQ(tuned_once().rows[2].evaluations, 6) << "a limit has no numbers: bandwidths alone";
  EXPECT_GE(tuned_once().rows[1].evaluations, 12);
}

TEST(StudyTuning, LeavesThresholdsForItsPairsInThatCondition) {
  const Thresholds& t = tuned_once().thresholds;
  EXPECT_EQ(t.margin, 1.1);
  for (const study::TunedRow& r : tuned_once().rows) {
    const DetectorThresholds known =
        trained_for(t, robot("wallmobot3"), 1e-4, r.estimator, r.detector, "light");
    EXPECT_EQ(known.size(), r.detector.starts_with("contact") ? 2u : 1u);
    for (const auto& [name, trained] : known) EXPECT_GT(trained.threshold.minCoeff(), 0) << name;
  }
}

TEST(StudyTuning, DoesNotDependOnTheNumberOfThreads) {
  StudyTuning o = small();
  o.detectors = {"high_pass"};
  o.threads = 1;
  const study::TunedStudy one = tuned(o);
  ASSERT_EQ(one.rows.size(), 1u);
  EXPECT_EQ(one.rows[0].estimator, tuned_once().rows[1].estimator);
  EXPECT_EQ(one.rows[0].detector, tuned_once().rows[1].detector);
  EXPECT_EQ(one.rows[0].recall, tuned_once().rows[1].recall);
}

TEST(StudyTuning, InPartsIsTheWholeWhicheverComesFirst) {
  StudyTuning o = small();
  o.estimators = {"mo1", "mo2", "mo3"};
  o.detectors = {"threshold"};
  const auto text_of = [](const study::TunedStudy& t) {
    const std::string path = std::filesystem::temp_directory_path() / "tuned_parts_test.json";
    study::write_tuned(t, path);
    std::stringstream text;
    text << std::ifstream(path).rdbuf();
    return text.str();
  };
  const std::string whole = text_of(tuned(o));
  study::TunedStudy sum;
  std::size_t most = 0;
  for (const int part : {2, 1}) {
    o.shard = {part, 2};
    const study::TunedStudy more = tuned(o);
    most = std::max(most, more.rows.size());
    append(more, sum);
  }
  EXPECT_EQ(text_of(sum), whole);
  EXPECT_EQ(most, 2u) << "of 3";
}

TEST(StudyTuning, MergesFilesOfDifferentPairsAlone) {
  const std::string folder = testing::TempDir(), part = folder + "merge_part.json",
                    none = folder + "merge_none.json", sum = folder + "merge_sum.json";
  study::TunedStudy t = tuned_once();
  study::write_tuned(t, part);
  merge_tuned({part}, sum);
  EXPECT_EQ(study::read_tuned(sum).rows.size(), 3u);
  const auto refused = [&](const std::vector<std::string>& parts) {
    return error_of([&] { merge_tuned(parts, folder + "merge_other.json"); });
  };
  EXPECT_NE(refused({part, sum}).find(sum + ": mo1+contact_classifier for light on wallmobot3"),
            std::string::npos);
  t.rows.clear();
  study::write_tuned(t, none);
  EXPECT_NE(refused({part, none}).find(none + ": has no pairs"), std::string::npos);
  EXPECT_FALSE(std::filesystem::exists(folder + "merge_other.json")) << "nothing half done";
}

TEST(StudyTuning, SearchesAKeyThatEstimatorAndDetectorBothHave) {
  StudyTuning o = small();
  o.estimators = {"eso"};
  o.detectors = {"high_pass"};
  const study::TunedStudy found = tuned(o);
  ASSERT_EQ(found.rows.size(), 1u);
  EXPECT_NE(found.rows[0].detector, "high_pass") << "w = 10 rad/s is not the best";
  EXPECT_EQ(found.rows[0].estimator.find(":w="), std::string::npos);
}

TEST(StudyTuning, SkipsWhatIsKnownAndWhatItHasNoTimeFor) {
  EXPECT_TRUE(tuned(small(), tuned_once().rows).rows.empty());
  StudyTuning o = small();
  o.stop = [] { return true; };
  EXPECT_TRUE(tuned(o).rows.empty());
}

TEST(StudyTuning, RefusesWhatCannotBe) {
  StudyTuning o = small();
  o.conditions = {"known_150"};
  EXPECT_NE(error_of([&] { tune_study(o, {}); }).find("tune for light, typical, hard"),
            std::string::npos);
  o.conditions = {};
  EXPECT_NE(error_of([&] { tune_study(o, {}); }).find("no condition"), std::string::npos);
  o = small();
  o.evaluations = 17;
  EXPECT_NE(error_of([&] { tune_study(o, {}); }).find("18 evaluations (not 17)"),
            std::string::npos);
}

TEST(TrainingRuns, FindLessWithHigherThresholds) {
  const study::StudyRuns& runs = study::touched_runs();
  const TrainingRuns training(runs, study::condition(runs, "light"), 2, 1, 2);
  const auto seen = training.seen_by("mo1");
  ASSERT_FALSE(seen.empty());
  EXPECT_EQ(training.recall(seen, {"mo1", "high_pass:threshold=1e9"}, 1.1), 0);
  const double some = training.recall(seen, {"mo1", "high_pass:w=60"}, 1.1),
               less = training.recall(seen, {"mo1", "high_pass:w=60"}, 3);
  EXPECT_GT(some, 0.1);
  EXPECT_LT(some, 1);
  EXPECT_LT(less, some) << "higher thresholds find less";
}

}  // namespace
}  // namespace tauext::test
