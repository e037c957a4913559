// SPDX-License-Identifier: Apache-2.0
#include "bench/study/detection/study_parts.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <memory>
#include <sstream>

#include "bench/study/detection/detection_report.h"
#include "mjcf/test/error_of.h"
#include "mjcf/trace/input_file.h"

namespace tauext::study::test {
namespace {

using tauext::test::error_of;

class StudyParts : public ::testing::Test {
 protected:
  StudyParts() {
    folder_ = std::filesystem::temp_directory_path() /
              ("study_parts_" + std::to_string(::testing::UnitTest::GetInstance()->random_seed()) +
               "_" + std::to_string(::getpid()) + "_" +
               ::testing::UnitTest::GetInstance()->current_test_info()->name());
    std::filesystem::create_directory(folder_);
  }
  ~StudyParts() override { std::filesystem::remove_all(folder_); }

  static StudyOptions small() {
    StudyOptions o;
    o.conditions = {"known_150", "noise_known_150"};
    o.estimators = {"mo1", "mo2"};
    o.detectors = {"pan_tompkins", "clamping"};
    o.blows = 90;  // several pieces
    o.brisk_pushes = 8;
    o.clampings = 3;
    o.regions = 1;
    o.hours = 0.08;
    o.threads = 2;
    return o;
  }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  bool run(const std::string& shard, const std::string& name, const StudyOptions& o) const {
    const DetectionStudy study(o, {});
    return run_part(study, about(o, {}), shard_of(shard), path(name), o);
  }
  // programs that merge do nothing else with these files
  static Merged merged(const std::vector<std::string>& paths) {
    const std::shared_ptr<void> last(nullptr, [&](void*) {
      for (const std::string& p : paths) release_input(p);
    });
    return merge_parts(paths);
  }
  static std::string json(const std::vector<Cell>& cells) {
    return study_json(touched_runs(), cells, {});
  }

  std::filesystem::path folder_;
};

TEST_F(StudyParts, PutTogetherAreTheWholeToTheLastByte) {
  const StudyOptions o = small();
  const std::string whole = json(detection_study(o, {}));
  std::vector<std::string> parts;
  for (const char* shard : {"3/3", "1/3", "2/3"}) {
    parts.push_back(path(std::string("part") + shard[0]));
    StudyOptions mine = o;
    mine.threads = shard[0] - '0';
    EXPECT_TRUE(run(shard, parts.back().substr(folder_.string().size() + 1), mine));
  }
  const Merged whole_again = merged(parts);
  EXPECT_EQ(json(whole_again.cells), whole);
  EXPECT_EQ(whole_again.about.robot, &robot("wallmobot3"));
  EXPECT_EQ(whole_again.about.plan.at("collisions"), 90);
}

TEST_F(StudyParts, OneThatWasStoppedOrKilledGoesOn) {
  StudyOptions o = small();
  int asked = 0;
  o.threads = 1;
  o.stop = [&asked] { return ++asked > 4; };
  EXPECT_FALSE(run("1/1", "p", o));
  const auto done = std::filesystem::file_size(path("p"));
  EXPECT_NE(error_of([&] { merged({path("p")}); }).find("are missing, of --shard 1/1"),
            std::string::npos);
  // killed within a line
  std::ofstream(path("p"), std::ios::app) << R"({"piece":17,"adds":{"0":{"ru)";
  o.stop = nullptr;
  EXPECT_TRUE(run("1/1", "p", o));
  EXPECT_GT(std::filesystem::file_size(path("p")), done);
  EXPECT_EQ(json(merged({path("p")}).cells), json(detection_study(o, {})));
  const auto all = std::filesystem::file_size(path("p"));
  EXPECT_TRUE(run("1/1", "p", o));
  EXPECT_EQ(std::filesystem::file_size(path("p")), all) << "nothing is done twice";
}

TEST_F(StudyParts, AnotherStudysAreRefused) {
  StudyOptions o = small();
  o.conditions = {"known_150"};
  o.blows = 8;
  o.regions = 0;
  run("1/2", "a", o);
  EXPECT_NE(error_of([&] { run("2/2", "a", o); }).find("another part"), std::string::npos);
  o.first_seed = 5;
  EXPECT_NE(error_of([&] { run("1/2", "a", o); }).find("is a part of another study"),
            std::string::npos);
  run("2/2", "b", o);
  EXPECT_NE(error_of([&] {
              merged({path("a"), path("b")});
            }).find("another study than"),
            std::string::npos);
  EXPECT_NE(error_of([&] {
              merged({path("a"), path("a")});
            }).find("has a piece that"),
            std::string::npos);
  EXPECT_NE(error_of([&] { merged({path("a")}); }).find("of --shard 2/2"), std::string::npos);
  std::ofstream(path("x")) << "t,q1\n0,0\n";
  EXPECT_NE(error_of([&] { merged({path("x")}); }).find("line 1: "), std::string::npos);
  EXPECT_NE(error_of([&] { run("1/2", "x", o); }).find("no part of a study"), std::string::npos);
  EXPECT_EQ(std::filesystem::file_size(path("x")), 9u) << "and left as it was";
  // one line without an end may be somebody's note
  std::ofstream(path("note")) << "a note";
  EXPECT_NE(error_of([&] { run("1/2", "note", o); }).find("its last line is none of ours"),
            std::string::npos);
  EXPECT_EQ(std::filesystem::file_size(path("note")), 6u);
  EXPECT_NE(error_of([&] { merged({path("nothing")}); }).find("No such file"), std::string::npos);
}

// the text with one part of it replaced
std::string edited(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, text.npos) << from;
  return text.replace(at, from.size(), to);
}

TEST_F(StudyParts, WhatIsNotOfAPartIsRefusedWithItsLine) {
  StudyOptions o = small();
  o.conditions = {"known_150"};
  o.regions = 0;
  run("1/2", "a", o);
  std::stringstream text;
  text << std::ifstream(path("a")).rdbuf();
  const auto error = [&](const std::string& from, const std::string& to) {
    std::ofstream(path("bad")) << edited(text.str(), from, to);
    const std::string what = error_of([&] { merged({path("bad")}); });
    EXPECT_EQ(what.find(path("bad") + ": no part of a study"), 0u) << what;
    return what;
  };
  EXPECT_NE(error("{\"piece\":0,", "{\"piece\":1,").find("piece 1 is not of this part"),
            std::string::npos);
  EXPECT_NE(error("{\"piece\":0,", "{\"piece\":99998,").find("piece 99998"), std::string::npos);
  EXPECT_NE(error("\"adds\":{\"0\":", "\"adds\":{\"77\":").find("there is no cell 77"),
            std::string::npos);
  EXPECT_NE(error("\"shard\":[1,2]", "\"shard\":[1,0]").find("line 1: "), std::string::npos);
  EXPECT_NE(error("\"pieces\"", "\"pisces\"").find("line 1: "), std::string::npos);
  EXPECT_NE(error("\"context\"", "\"contest\"").find("line 1: "), std::string::npos);
}

TEST_F(StudyParts, HaveOneWriter) {
  const Journal one(path("j"));
  EXPECT_NE(error_of([&] { Journal another(path("j")); }).find("another program is writing it"),
            std::string::npos);
}

TEST(Shard, IsIOfN) {
  EXPECT_EQ(shard_of("2/7").index, 2);
  EXPECT_EQ(shard_of("2/7").count, 7);
  for (const char* bad : {"", "/", "0/3", "4/3", "1/", "/3", "1/0", "-1/3", "1/3x", "a/b", "1"})
    EXPECT_NE(error_of([&] { shard_of(bad); }).find("the I-th of N parts"), std::string::npos)
        << bad;
}

}  // namespace
}  // namespace tauext::study::test
