// SPDX-License-Identifier: Apache-2.0
// A robot from a file, in every program.
#include <cctype>
#include <cmath>
#include <fstream>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "arm7.h"  // by tauext-import, from bench/examples/arm7.xml
#include "arm7_with_gripper.h"
#include "bench/test/programs.h"
#include "mjcf/plant/plant.h"
#include "mjcf/plant/simulated.h"
#include "mjcf/plant/tree.h"

namespace tauext::test {
namespace {

const std::string kArm6 = kExamples + "/arm6.xml";
const std::string kArm7 = kExamples + "/arm7.xml --lock 'finger.*'";
const std::string kTwoArms = kExamples + "/two_arms.urdf";

// what the header has, beside MuJoCo on the file
template <class Arm>
void expect_arm_of_the_file(const Arm& arm, const std::string& lock) {
  Plant plant(simulated(load_mjcf(kExamples + "/arm7.xml", {lock})));
  ASSERT_EQ(plant.dof(), Arm::kDof);
  for (int k = 0; k < 20; ++k) {
    Vec<Arm::kDof> q, qd;
    for (int i = 0; i < Arm::kDof; ++i) {
      q[i] = std::sin(3. * k + i);
      qd[i] = std::cos(5. * k + 2 * i);
    }
    plant.set_state(q, qd);
    EXPECT_LT((arm.inertia(q) - plant.inertia()).norm(), 1e-10);
    EXPECT_LT((arm.bias(q, qd) - plant.bias()).norm(), 1e-10);
    EXPECT_LT((arm.friction(qd) - plant.friction()).norm(), 1e-10);
  }
}

TEST(ImportedArm, AsCppIsTheArmOfTheFile) {
  expect_arm_of_the_file(make_arm7(), "finger.*");
  expect_arm_of_the_file(make_arm7_with_gripper(), "");
}

using FilePrograms = Programs;

// the gripper is an eighth joint: one finger moves as the other does
TEST_F(FilePrograms, AFingerFollowsTheOtherOneInEveryProgram) {
  const std::string arm = " --robot " + kExamples + "/arm7.xml";
  const Outcome o =
      run("tauext-bench" + arm + " --benchmark_filter='/(step|in_motion)/(mo2|ekf)$' " +
          "--benchmark_min_time=0.01 --benchmark_out=r.json");
  EXPECT_EQ(o.code, 0) << o.text;
  std::map<std::string, double> rmse;
  const auto results = nlohmann::json::parse(content("r.json"));
  for (const auto& row : results.at("benchmarks")) rmse[row.at("name")] = row.at("rmse_Nm");
  ASSERT_EQ(rmse.size(), 4u) << o.text;
  EXPECT_LT(rmse.at("arm7/step/ekf"), 1.5 * rmse.at("arm7/step/mo2"));
  EXPECT_LT(rmse.at("arm7/in_motion/mo2"), 0.01) << "nothing acts on it";
  ASSERT_EQ(run("tauext-record" + arm + " --scenario blow --out x.csv").code, 0);
  const Outcome force =
      run("tauext-replay x.csv" + arm + " --estimator truth --wrench end_effector --out e.csv");
  EXPECT_EQ(force.code, 0) << force.text;
  EXPECT_TRUE(force.says("joint 6 carries the link that is touched, or one behind it") ||
              force.says("joint 7 carries"))
      << force.text;
}

TEST_F(FilePrograms, TheSuiteRunsOnIt) {
  const Outcome list = run("tauext-bench --list --robot " + kTwoArms);
  EXPECT_EQ(list.code, 0) << list.text;
  EXPECT_TRUE(list.says("two_arms/contact/mo2+pan_tompkins\n")) << list.text;
  EXPECT_FALSE(list.says("wallmobot3/"));
  const Outcome o = run("tauext-bench --robot " + kArm7 +
                        " --benchmark_filter='arm7/(step|blow)/(mo2|ekf)' "
                        "--benchmark_min_time=0.01 --benchmark_out=r.json");
  EXPECT_EQ(o.code, 0) << o.text;
  const auto results = nlohmann::json::parse(content("r.json")).at("benchmarks");
  double mo2 = 0, ekf = 0, recall = 0;
  for (const auto& row : results) {
    const std::string name = row.at("name");
    if (name == "arm7/step/mo2") mo2 = row.at("rmse_Nm");
    if (name == "arm7/step/ekf") ekf = row.at("rmse_Nm");
    if (name == "arm7/blow/mo2+pan_tompkins") recall = row.at("recall");
  }
  EXPECT_GT(mo2, 0.01) << "a step costs every estimator its delay";
  EXPECT_LT(mo2, 1);
  EXPECT_LT(ekf, 1.5 * mo2);
  EXPECT_EQ(recall, 1);
}

TEST_F(FilePrograms, RecordsAndReplaysIt) {
  const Outcome list = run("tauext-record --list --robot " + kArm6);
  EXPECT_TRUE(list.says("blow       half sines of ") && list.says("used to")) << list.text;
  EXPECT_FALSE(list.says("wallmobot3"));
  const Outcome record = run("tauext-record --robot " + kArm6 + " --scenario sine --out x.csv");
  EXPECT_EQ(record.code, 0) << record.text;
  const Outcome replay =
      run("tauext-replay x.csv --robot " + kArm6 + " --estimator truth,mo2,ekf --out e.csv");
  EXPECT_EQ(replay.code, 0) << replay.text;
}

// whoever reads a recording multiplies its torques by torque_gain
TEST_F(FilePrograms, ATorqueGainChangesNothingOfOnesOwnRecordings) {
  std::string plain = content(kExamples + "/arm6.json");
  plain.replace(plain.find("arm6.xml"), 8, kExamples + "/arm6.xml");
  write("plain.json", plain);
  std::string scaled = plain;
  for (std::size_t at = 0; (at = scaled.find("\"gain\"", at)) != scaled.npos; at += 30)
    scaled.insert(at, "\"torque_gain\": 1.25, ");
  write("scaled.json", scaled);
  for (const std::string robot : {"plain", "scaled"}) {
    const std::string arm = " --robot " + robot + ".json";
    ASSERT_EQ(run("tauext-record --scenario push --out " + robot + ".csv" + arm).code, 0);
    const Outcome o =
        run("tauext-replay " + robot + ".csv --estimator mo2 --out " + robot + "_mo2.csv" + arm);
    EXPECT_EQ(o.code, 0) << o.text;
  }
  EXPECT_NE(content("plain.csv"), content("scaled.csv"));
  std::istringstream a(content("plain_mo2.csv")), b(content("scaled_mo2.csv"));
  std::string one, other;
  std::getline(a, one), std::getline(b, other);
  int rows = 0;
  for (; std::getline(a, one) && std::getline(b, other); ++rows) {
    std::istringstream left(one), right(other);
    for (std::string x, y; std::getline(left, x, ',') && std::getline(right, y, ',');)
      ASSERT_NEAR(std::stod(x), std::stod(y), 1e-9) << "row " << rows;
  }
  EXPECT_GT(rows, 1000);
}

TEST_F(FilePrograms, SayOnceWhatTheImportChanged) {
  const auto times = [](const std::string& text, const std::string& what) {
    int n = 0;
    for (std::size_t at = 0; (at = text.find(what, at)) != text.npos; ++at) ++n;
    return n;
  };
  const Outcome locked = run("tauext-record --robot " + kArm7 + " --scenario step --out x.csv");
  EXPECT_EQ(times(locked.text, "arm7.xml: changed: 2 joint locked; left out: "), 1) << locked.text;
  const Outcome ours = run("tauext-record --robot wallmobot3 --scenario step --out x.csv");
  EXPECT_EQ(times(ours.text, "left out: "), 0) << ours.text;
}

TEST_F(FilePrograms, CalibratesAndStudiesIt) {
  const std::string few =
      " --robot " + kTwoArms + " --estimator mo2 --detector high_pass,pan_tompkins";
  const Outcome list = run("tauext-detect --list --robot " + kTwoArms);
  EXPECT_TRUE(list.says("heavy") && list.says("(trained on)")) << list.text;
  const Outcome calibrate = run("tauext-detect --calibrate t.json --runs 2" + few);
  EXPECT_EQ(calibrate.code, 0) << calibrate.text;
  const Outcome study =
      run("tauext-detect --thresholds t.json --conditions known --collisions 20 "
          "--pushes 0 --clampings 0 --hours 0.02 --format csv" +
          few);
  EXPECT_EQ(study.code, 0) << study.text;
  EXPECT_TRUE(study.says("known,mo2+pan_tompkins,100.0,")) << study.text;
}

TEST_F(FilePrograms, ThresholdsAreOfTheArmThatTheyWereTrainedOn) {
  std::ifstream file(kTwoArms);
  std::string arm{std::istreambuf_iterator<char>(file), {}};
  const std::string few = "--robot own.urdf --estimator mo2 --detector high_pass";
  write("own.urdf", arm);
  const Outcome made = run("tauext-detect --calibrate t.json --runs 1 " + few);
  ASSERT_EQ(made.code, 0) << made.text;
  write("same.urdf", arm);
  const Outcome same =
      run("tauext-detect --thresholds t.json --robot same.urdf --estimator mo2 --detector "
          "high_pass --collisions 1 --pushes 1 --clampings 1 --hours 0.01");
  EXPECT_EQ(same.code, 0) << "an arm goes by what it is, not by its path: " << same.text;
  const auto mass = arm.find("<mass value=\"") + 13;
  ASSERT_GT(mass, 13u);
  write("own.urdf", arm.insert(mass, "1"));  // 112 kg instead of 12
  const Outcome study = run("tauext-detect --thresholds t.json " + few);
  EXPECT_EQ(study.code, 2);
  EXPECT_TRUE(study.says("they are of another arm than ")) << study.text;
  fs::create_directory(folder_ / "other");
  write("other/own.urdf", arm);
  const Outcome other = run(
      "tauext-detect --thresholds t.json --robot other/own.urdf --conditions known --estimator mo2 "
      "--detector high_pass");
  EXPECT_TRUE(other.says("it is for own.urdf, another arm whose file has that name")) << other.text;
}

// that of bench/run/README.md
std::string own_scenario() {
  std::ifstream readme(kExamples + "/../run/README.md");
  const std::string text{std::istreambuf_iterator<char>(readme), {}};
  const auto begin = text.find("```json") + 7;
  return text.substr(begin, text.find("```", begin) - begin);
}

TEST_F(FilePrograms, RunScenariosOfAFile) {
  write("own.json", own_scenario());
  const Outcome bench = run("tauext-bench --robot " + kArm7 +
                            " --scenarios own.json --benchmark_filter='pick/mo2' "
                            "--benchmark_min_time=0.001 --benchmark_out=r.json");
  ASSERT_EQ(bench.code, 0) << bench.text;
  const auto rows = nlohmann::json::parse(content("r.json")).at("benchmarks");
  EXPECT_EQ(rows.at(0).at("name"), "arm7/pick/mo2");
  EXPECT_GT(rows.at(0).at("rmse_Nm"), 0.1) << "the model does not know 2 % of the last link";
  const Outcome record =
      run("tauext-record --robot " + kArm7 + " --scenarios own.json --scenario pick --out x.csv");
  ASSERT_EQ(record.code, 0) << record.text;
  std::istringstream rows_of_csv(content("x.csv"));
  std::string line;
  std::map<int, std::vector<double>> at;  // by millisecond
  for (int n = 0; std::getline(rows_of_csv, line);) {
    if (line.empty() || (std::isdigit(line[0]) == 0 && line[0] != '-')) continue;
    std::istringstream numbers(line);
    for (std::string x; std::getline(numbers, x, ',');) at[n].push_back(std::stod(x));
    ++n;
  }
  // t, 7 q, 7 qd, 7 tau, 7 tau_ext, contact
  ASSERT_EQ(at.size(), 10000U);
  EXPECT_NEAR(at[3500][2], 0.6, 0.01) << "q2 at the second way point";
  EXPECT_NEAR(at[3500][7], 0.1 * std::sin(2 * 3.5), 0.01) << "q7 on its sine";
  EXPECT_EQ(at[5000][23], 5) << "tau_ext 2 by (3)";
  EXPECT_EQ(at[3999][23], 0);
  EXPECT_NEAR(at[7000][25], std::sin(3 * 7.), 1e-12);
  EXPECT_EQ(at[8005].back(), 1);
  EXPECT_EQ(at[8025].back(), 0);
}

TEST_F(FilePrograms, AskOnlyJointsThatAreLoaded) {
  write("own.json", R"({"scenarios": [
    {"name": "kick", "duration": 5, "asks": "step",
     "loads": [{"joint": 2, "torque": 5, "from": 1, "to": 3}]},
    {"name": "swept", "duration": 34, "asks": "bandwidth",
     "loads": [{"joint": 6, "torque": 2, "from": 2, "sweep": true}]}]})");
  const Outcome o = run("tauext-bench --robot " + kArm7 +
                        " --scenarios own.json --benchmark_filter='(kick|swept)/(mo1|truth)$' "
                        "--benchmark_min_time=0.001 --benchmark_out=r.json");
  ASSERT_EQ(o.code, 0) << o.text;
  std::map<std::string, nlohmann::json> rows;
  const auto all = nlohmann::json::parse(content("r.json")).at("benchmarks");
  for (const auto& row : all) rows[row.at("name")] = row;
  const auto& mo1 = rows.at("arm7/kick/mo1");  // of first order at 30 rad/s
  EXPECT_NEAR(mo1.at("rise_s"), std::log(9) / 30, 1e-3);
  EXPECT_NEAR(mo1.at("settling_s"), std::log(50) / 30, 2e-3);
  EXPECT_EQ(rows.at("arm7/kick/truth").at("settling_s"), 0);
  EXPECT_NEAR(rows.at("arm7/swept/mo1").at("bandwidth_rad_s"), 30, 0.5);
}

TEST_F(FilePrograms, SayWhatIsWrongInAScenario) {
  const auto refuses = [&](const std::string& from, const std::string& to, const std::string& why) {
    std::string text = own_scenario();
    text.replace(text.find(from), from.size(), to);
    write("own.json", text);
    const Outcome o =
        run("tauext-record --robot " + kArm7 + " --scenarios own.json --scenario pick --out x.csv");
    EXPECT_EQ(o.code, 2) << to;
    EXPECT_TRUE(o.says("own.json: ") && o.says(why)) << to << "\n" << o.text;
    EXPECT_FALSE(exists("x.csv"));
  };
  refuses("\"duration\": 10", "\"duration\": -1", "\"duration\" is -1, and must be 0.1 to 3600");
  refuses("\"joint\": 7", "\"joint\": 8",
          "scenarios 1: sines 1: \"joint\" is 8, and must be 1 to 7");
  refuses("\"torque\": 5", "\"torqe\": 5", "unknown key \"torqe\"; known: joint, torque");
  refuses("\"blow\"", "\"kick\"",
          "scenarios 1: touches 1: unknown kind 'kick'; known: blow, push, clamp");
  refuses("\"asks\": \"detection\"", "\"asks\": \"all\"", "known: error, step, lag");
  refuses("\"asks\": \"detection\"", "\"asks\": \"bandwidth\"", "each with \"sweep\": true");
  refuses("\"to\": 6", "\"to\": 4", "loads 1: \"to\" is 4, and must be after \"from\", 4");
  refuses("\"w\": 3", "\"sweep\": true", "a \"sweep\" of 10 s is too short");
  refuses("[0, 0, 40]", "[0, 0, 0]", "touches 1: \"force\" is zero");
  refuses("\"t\": 8", "\"t\": 9.99", "grows from 9.99 to 10.01 s, and the scenario ends at 10 s");
  refuses("\"t\": 3,", "\"t\": 30,", "way_points 2: \"t\" is 30, and must be 0 to 10");
  refuses("\"t\": 8", "\"t\": 8, \"t\": 9", "the key \"t\" is there twice");
  refuses("1e-3, ", "1e-3, \"noise\": 1, ", "scenarios 1: degrade: ");
  refuses("[0, 0, 40]", "[0, 40]", "\"force\" is [0,40], and must be 3 numbers");
  refuses("\"t\": 3,", "\"t\": 0,", "must be later than the one before");
  refuses("\"t\": 8", "\"t\": 80", "\"t\" is 80, and must be 0 to 10");
  refuses(own_scenario(), R"({"scenarios": [{"name": "pick", "duration": 5, "asks": "step"}]})",
          "\"asks\" is 'step', and there are no \"loads\" to answer");
  refuses(own_scenario(),
          R"({"scenarios": [{"name": "pick", "duration": 5, "asks": "lag",
              "loads": [{"joint": 1, "torque": 3}]}]})",
          "\"asks\" is 'lag', and no load changes");
  refuses(own_scenario(),
          R"({"scenarios": [{"name": "pick", "duration": 2, "asks": "lag",
              "loads": [{"joint": 1, "torque": 3, "from": 1}]}]})",
          "\"duration\" must be 2.1 or more, not 2");
  refuses(own_scenario(),
          R"({"scenarios": [{"name": "pick", "duration": 5, "asks": "step",
              "loads": [{"joint": 1, "torque": 3, "from": 5}]}]})",
          "\"from\" is 5, the end of the scenario");
  refuses(own_scenario(),
          R"({"scenarios": [{"name": "pick", "duration": 5, "asks": "step",
              "loads": [{"joint": 1, "torque": 3, "from": 1, "w": 4}]}]})",
          "so there must be constant \"loads\", and nothing else");
  refuses("\"pick\"", "\"step\"", "'step'");
  refuses("\"pick\"", "\"a/b\"", "must be a word");
  refuses("\"velocity_noise\"", "\"noise\"", "velocity_noise");
  refuses("\"name\"", "name", "parse error");
}

TEST_F(FilePrograms, SayWhatIsWrongWithIt) {
  EXPECT_TRUE(run("tauext-bench --lock x").says("--lock: of which --robot FILE?"));
  EXPECT_TRUE(run("tauext-bench --robot wallmobot3 --lock x").says("wallmobot3 is none"));
  EXPECT_TRUE(run("tauext-bench --robot a.xml --lock ''").says("--lock: its value is empty"));
  std::ostringstream text;
  text << std::ifstream(kExamples + "/arm7.xml").rdbuf();
  std::string curved = text.str();
  curved.insert(curved.find("joint1="), "polycoef='0 1 .1 0 0' ");
  write("curved.xml", curved);
  const Outcome tied = run("tauext-bench --robot curved.xml");
  EXPECT_EQ(tied.code, 2);
  EXPECT_TRUE(tied.says("follows another by a polynomial") && tied.says("--lock REGEX fixes it"))
      << tied.text;
  EXPECT_EQ(run("tauext-record --robot nothing.urdf --scenario step --out x.csv").code, 2);
  EXPECT_TRUE(
      run("tauext-record --robot " + kArm6 + " --scenario dance --out x.csv")
          .says("known: free, step, ramp, sine, in_motion, chirp, push, blow, clamp, contact"));
}

}  // namespace
}  // namespace tauext::test
