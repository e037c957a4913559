// SPDX-License-Identifier: Apache-2.0
#include "bench/roster/specification.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "bench/roster/detector_list.h"
#include "bench/roster/robots.h"
#include "bench/roster/roster.h"
#include "mjcf/test/error_of.h"

namespace tauext::test {
namespace {

TEST(Specification, IsANameAndKeysInTheirOrder) {
  const Specification s = parse_specification("contact_classifier:collision.hold=0.1:hold=2");
  EXPECT_EQ(s.name, "contact_classifier");
  EXPECT_EQ(s.keys, (KeyValues{{"collision.hold", "0.1"}, {"hold", "2"}}));
  EXPECT_EQ(parse_specification("ndob:X=1/2/3").keys, (KeyValues{{"X", "1/2/3"}}));
  EXPECT_TRUE(parse_specification("mo2").keys.empty());
  EXPECT_EQ(name_of_specification("mo2:bandwidth=50"), "mo2");
  EXPECT_EQ(parse_specification(at_bandwidth("mo2", 1. / 3)).keys[0].second, "0.3333333333333333");
}

TEST(Specification, WithoutANameOrAValueOrWithAKeyTwiceIsNone) {
  const auto why = [](const char* text) {
    const std::string what = error_of([&] { parse_specification(text); });
    const std::string begin = "'" + std::string(text) +
                              "' is no specification name[:key=value]..., like mo2:bandwidth=50: ";
    EXPECT_EQ(what.substr(0, begin.size()), begin);
    return what.substr(std::min(begin.size(), what.size()));
  };
  EXPECT_EQ(why(""), "it has no name");
  EXPECT_EQ(why(":w=3"), "it has no name");
  EXPECT_EQ(why("mo2:"), "'' is not key=value");
  EXPECT_EQ(why("mo2:bandwidth"), "'bandwidth' is not key=value");
  EXPECT_EQ(why("mo2:bandwidth="), "'bandwidth=' is not key=value");
  EXPECT_EQ(why("mo2:=50"), "'=50' is not key=value");
  EXPECT_EQ(why("mo2:bandwidth=50:bandwidth=60"), "'bandwidth' is set twice");
}

// ---- robots

const WallMoBot3 kArm;

// an arm that starts in motion, and a load on it from 0.2 s on
const Trace& trace() {
  static const Trace recorded = [] {
    Scenario s = quiet();
    s.duration = 0.6;
    s.start_on_reference = true;
    s.reference = [](double t, int) { return sine_motion(0.3, 3, t); };
    s.tau_ext = [](double t, int) { return t < 0.2 ? 0 : 50; };
    return record(load_robot("wallmobot3"), s);
  }();
  return recorded;
}

const Robot& wallmobot3() {
  return robot("wallmobot3");
}

Eigen::MatrixXd by_name(const std::string& specification) {
  return wallmobot3().run(specification, trace()).tau_ext;
}

template <class E>
Eigen::MatrixXd by_hand(E e) {
  Eigen::MatrixXd out(3, trace().size());
  for (int k = 0; k < trace().size(); ++k) {
    out.col(k) = e.update(trace().measurement<3>(k)).tau_ext;
  }
  return out;
}

std::string error_by_name(const std::string& specification) {
  return error_of([&] { by_name(specification); });
}

TEST(Specification, OfABandwidthGivesTheEstimatesOfThatDesignToTheBit) {
  using Mo2 = MomentumObserver2<WallMoBot3>;
  const Eigen::MatrixXd fifty = by_name("mo2:bandwidth=50");
  EXPECT_EQ(fifty, by_hand(Mo2(kArm, Mo2::Parameters::for_bandwidth(kArm, 50))));
  EXPECT_NE(fifty, by_name("mo2"));
  EXPECT_EQ(by_name("mo2:bandwidth=30"), by_name("mo2")) << "the roster's own bandwidth";
}

TEST(Specification, SetsTheBandwidthOfEveryTunableEstimator) {
  const std::vector<std::string> tunable = wallmobot3().tunable();
  std::size_t count = 0;
  for_each_estimator(kArm, [&](const auto& entry) {
    using E = decltype(entry());
    if (std::count(tunable.begin(), tunable.end(), E::kName) == 0) return;
    if constexpr (requires { E::Parameters::for_bandwidth(kArm, 70.); }) {
      EXPECT_EQ(by_name(at_bandwidth(E::kName, 70)),
                by_hand(E(kArm, E::Parameters::for_bandwidth(kArm, 70))))
          << E::kName;
      EXPECT_EQ(wallmobot3().estimator_fields(E::kName).front().key, "bandwidth");
      ++count;
    }
  });
  EXPECT_EQ(count, tunable.size());
}

TEST(Specification, TunableEstimatorsAreThoseOfBothRobotsThatHaveAFormulaForABandwidth) {
  const std::vector<std::string> tunable{
      "inverse_dynamics", "mo1", "mo2", "mo3", "ndob_wb", "dkf",
      "dkf_adaptive",     "smo", "aob", "eso", "ekf",     "ndob"};
  EXPECT_EQ(wallmobot3().tunable(), tunable);
  EXPECT_EQ(robot("testbed1").tunable(), tunable);
}

TEST(Specification, OfATraceWhoseTorqueIsReadAtInstantsNeedNotSayIt) {
  Trace instants = trace();
  instants.torque_at_instants = true;
  const auto by_trace = [&](const char* e) { return wallmobot3().run(e, instants).tau_ext; };
  for (const std::string e : {"mo2", "ekf", "mo2:bandwidth=50"}) {
    EXPECT_EQ(by_trace(e.c_str()), by_name(e + ":torque=instant")) << e;
    EXPECT_NE(by_trace(e.c_str()), by_name(e)) << e;
  }
  EXPECT_EQ(by_trace("mo2:torque=held"), by_name("mo2")) << "what it says counts";
  EXPECT_EQ(by_trace("zero"), by_name("zero")) << "which has no such key";
}

TEST(Specification, ChangesWhatItNamesOfTheRostersOwnParameters) {
  auto p = Ekf<WallMoBot3>::Parameters::paper();
  p.integration = Integration::kEuler;
  EXPECT_EQ(by_name("ekf:integration=euler"), by_hand(Ekf<WallMoBot3>(kArm, p)));
  EXPECT_NE(by_name("ekf:integration=euler"), by_name("ekf"));
  p.alignment = Alignment::kPaper;
  p.start = Start::kZero;
  EXPECT_EQ(by_name("ekf:integration=euler:alignment=paper:start=zero"),
            by_hand(Ekf<WallMoBot3>(kArm, p)));
  EXPECT_EQ(by_name("ekf:integration=second_order:alignment=held:start=first_measurement"),
            by_name("ekf"));
}

TEST(Specification, KeysBesideTheBandwidthWinWhereverTheyStand) {
  using Smo = SlidingModeObserver<WallMoBot3>;
  auto p = Smo::Parameters::for_bandwidth(kArm, 50);
  p.S1.setConstant(7);
  EXPECT_EQ(by_name("smo:bandwidth=50:S1=7"), by_hand(Smo(kArm, p)));
  EXPECT_EQ(by_name("smo:S1=7:bandwidth=50"), by_name("smo:bandwidth=50:S1=7"));
  EXPECT_NE(by_name("smo:bandwidth=50"), by_name("smo:bandwidth=50:S1=7"));
}

TEST(Specification, HasAValueForEachJointOrOneForAll) {
  using ArmNdob = Ndob<WallMoBot3>;
  EXPECT_EQ(by_name("ndob:X=600/700/800"), by_hand(ArmNdob(kArm, {.X = {600, 700, 800}})));
  EXPECT_EQ(by_name("ndob:X=600/600/600"), by_name("ndob:X=600"));
  EXPECT_EQ(by_name("ndob:X=600/1000/600"), by_name("ndob")) << "the paper's";
}

TEST(Specification, ThatMeansNothingSaysWhatWouldListingUnitsAndLimits) {
  const std::string known =
      "; known: bandwidth [rad/s] 0.001 to 1e+06, torque held|instant, max_gap [s] 0.0001 to 1000";
  EXPECT_EQ(error_by_name("mo2:bandwdith=50"),
            "mo2:bandwdith=50: there is no key 'bandwdith'" + known);
  EXPECT_EQ(error_by_name("mo2:bandwidth=0"),
            "mo2:bandwidth=0: bandwidth=0: it must be 0.001 to 1e+06" + known);
  EXPECT_EQ(error_by_name("mo2:max_gap=nan"),
            "mo2:max_gap=nan: max_gap=nan: it must be 0.0001 to 1000" + known);
  EXPECT_EQ(error_by_name("mo2:max_gap=1s"), "mo2:max_gap=1s: max_gap=1s: not a number" + known);
  EXPECT_EQ(error_by_name("zero:x=1"), "zero:x=1: there is no key 'x'; known: no keys at all");
  EXPECT_NE(error_by_name("ndob:X=1/2").find("X=1/2: 2 values, where 1 or 3 are wanted"),
            std::string::npos);
  EXPECT_NE(error_by_name("ekf:integration=eulre")
                .find("integration=eulre: it must be second_order or euler; known: bandwidth"),
            std::string::npos);
  EXPECT_NE(error_by_name("ekf_honest:bandwidth=50").find("there is no key 'bandwidth'"),
            std::string::npos)
      << "its tuning is fixed";
  EXPECT_NE(error_by_name("oracle:w=3").find("unknown estimator 'oracle'; known: zero, truth"),
            std::string::npos);
}

// ---- detectors, behind mo1

const Output& estimates() {
  static const Output out = wallmobot3().run("mo1", trace());
  return out;
}

// score and mark, sample by sample
using Verdicts = std::vector<std::pair<double, bool>>;

Verdicts said(const std::string& detector, const DetectorSettings& settings = {}) {
  Verdicts all;
  for (const Detection& d : wallmobot3().detect(detector, trace(), estimates(), settings)) {
    all.emplace_back(d.score, d.mark);
  }
  return all;
}

template <class D>
Verdicts said_by(D d) {
  Verdicts all;
  for (int k = 0; k < trace().size(); ++k) {
    const Measurement<3> y = trace().measurement<3>(k);
    const Detection x = detect(d, y.t, y.qd, y.tau, Vec<3>(estimates().tau_ext.col(k)));
    all.emplace_back(x.score, x.mark);
  }
  return all;
}

DetectorSettings trained() {
  DetectorSettings s;
  s.thresholds["high_pass"].threshold = Vec<3>(5, 6, 7);
  s.thresholds["pan_tompkins"].threshold = Vec<3>(5e4, 6e4, 7e4);
  return s;
}

TEST(Specification, OfADetectorHasTheLastWordAfterTraining) {
  EXPECT_EQ(said("high_pass:w=60", trained()),
            said_by(HighPass(3, {.threshold = Vec<3>(5, 6, 7), .w = 60})));
  EXPECT_EQ(said("high_pass:w=60:threshold=8", trained()),
            said_by(HighPass(3, {.threshold = Vec<3>::Constant(8), .w = 60})));
  EXPECT_NE(said("high_pass:w=60", trained()), said("high_pass", trained()));
  EXPECT_EQ(said("pan_tompkins:stride=3"), said_by(PanTompkins(3, {.stride = 3})));
}

TEST(Specification, ReachesTheDetectorsWithinADetector) {
  ContactClassifier::Parameters p;
  p.collision.threshold = Vec<3>(1e3, 2e3, 3e3);
  p.clamping.duration = 0.05;
  p.hold = 0.1;
  EXPECT_EQ(said("contact_classifier:collision.threshold=1e3/2e3/3e3:clamping.duration=0.05"
                 ":hold=0.1",
                 trained()),
            said_by(ContactClassifier(3, p)));
  EXPECT_NE(said("contact_classifier:collision.threshold=1e3"), said("contact_classifier"));
}

TEST(Specification, OfADetectorIsHeldToItsLimitsAndRelations) {
  const auto why = [](const char* detector) { return error_of([&] { said(detector); }); };
  EXPECT_EQ(why("high_pass:w=0").find("high_pass:w=0: w=0: it must be 0.001 to 1e+06; known: "),
            0u);
  EXPECT_NE(why("pan_tompkins:stride=2.5").find("stride=2.5: it must be a whole number"),
            std::string::npos);
  EXPECT_NE(why("pan_tompkins:stride=17").find("stride=17: it must be 1 to 16"), std::string::npos);
  EXPECT_NE(why("band_pass:w_low=200").find("w_low of band_pass must be below w_high"),
            std::string::npos);
  EXPECT_NE(why("contact_classifier:clamping.duration=-1")
                .find("clamping.duration=-1: it must be 1e-06 to 1000; known: collision.stride"),
            std::string::npos);
  EXPECT_NE(
      why("contact_classifier:collision=3").find("no key 'collision'; known: collision.stride"),
      std::string::npos);
}

// ---- what --list prints

TEST(ListFields, FitsAScreenAndHoldsEveryKey) {
  const std::string text = list_fields();
  std::istringstream lines(text);
  std::map<std::string, std::string> below;  // a name, the lines of its keys
  std::string name;
  for (std::string line; std::getline(lines, line);) {
    EXPECT_LE(line.size(), 100u) << line;
    if (line.starts_with("  :")) {
      below[name] += line + "\n";
    } else {
      name = line;
    }
  }
  const auto expect_all = [&](const std::string& of, const std::vector<FieldHelp>& fields) {
    for (const FieldHelp& f : fields) {
      EXPECT_NE(below[of].find("  :" + f.key + " "), std::string::npos) << of << " " << f.key;
      EXPECT_FALSE(f.effect.empty()) << f.key;
    }
  };
  for (const auto& r : robots()) {
    for (const std::string& e : r->estimators()) expect_all(e, r->estimator_fields(e));
    for (const std::string& d : r->detectors()) expect_all(d, r->detector_fields(d));
  }
  for (const char* key : {":collision.threshold ", ":clamping.w_baseline ", ":intentional "}) {
    EXPECT_NE(text.find(key), std::string::npos) << key;
  }
}

}  // namespace
}  // namespace tauext::test
