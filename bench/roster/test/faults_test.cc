// SPDX-License-Identifier: Apache-2.0
// Every estimator of the roster before every detector, on two robots of ours and arms of 6 and 7
// joints from a file, while the sensors fail.
#include "bench/kit/faults.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <memory>

#include "bench/roster/baselines.h"
#include "bench/roster/robots.h"
#include "bench/roster/test/hinge_robot.h"
#include "mjcf/record.h"

namespace tauext::test {
namespace {

struct Sample {
  double t = 0;
  Eigen::VectorXd q, qd, tau;
};
using Samples = std::vector<Sample>;

constexpr int kFault = 1500, kSlow = 770;  // samples, where the arm moves fastest and hardly at all

Trace moving(const Model& model, double load) {
  Scenario s = quiet();
  s.duration = 2.5;
  s.start_on_reference = true;
  s.reference = [](double t, int) { return sine_motion(0.3, 2, t); };
  s.tau_ext = [load](double, int) { return load; };
  Sensors sensors;  // of a good arm
  sensors.velocity_noise = 1e-3;
  sensors.encoder_step = 4.8e-5;
  return measure(record(model, s), sensors);
}

struct Run {
  Eigen::MatrixXd tau_ext;
  std::vector<Status> status;
  int joints = 0;  // samples that named one
  std::map<std::string, int> marks;
};

Run run(const Robot& robot, const std::string& estimator, const Samples& samples) {
  Run out{Eigen::MatrixXd(robot.dof(), samples.size()), {}, 0, {}};
  for (const std::string& d : robot.detectors()) {
    Pair pair = robot.pair(estimator, d, {});
    out.status.clear();
    for (std::size_t k = 0; k < samples.size(); ++k) {
      const Sample& y = samples[k];
      const StepResult s =
          pair.step(y.t, y.q.data(), y.qd.data(), y.tau.data(), out.tau_ext.col(k).data());
      out.status.push_back(s.status);
      out.joints += s.joints != 0;
      out.marks[d] += s.detection.mark;
    }
  }
  return out;
}

// [N m] the largest of the estimates that were said to be good, after the first second
double largest_error(const Run& r, double load) {
  double worst = 0;
  for (std::size_t k = 1000; k < r.status.size(); ++k) {
    if (r.status[k] != Status::kOk) continue;
    worst = std::max(worst, (r.tau_ext.col(k).array() - load).abs().maxCoeff());
  }
  return worst;
}

bool printed_form(const std::string& e) {
  return e == "ekf_raw_sign" || e == "ndob_raw_sign" || e == "ekf_zero_start";
}

// at sample `at` of a recording of which the estimator makes `clean`
void bears(const Robot& robot, const std::string& estimator, const Fault<Sample>& fault, int at,
           const Samples& good, const Run& clean, double load) {
  Samples bad = good;
  fault.apply(bad, at);
  const Run r = run(robot, estimator, bad);
  EXPECT_NE(r.joints + std::count_if(r.status.begin() + at, r.status.begin() + at + fault.samples,
                                     [](Status s) { return s != Status::kOk; }),
            0)
      << "nothing said";
  for (std::size_t k = at + fault.samples + 25; k < bad.size(); ++k) {
    ASSERT_EQ(r.status[k], Status::kOk) << "sample " << k;
  }
  const double error = largest_error(clean, load);
  if (fault.samples == 1) {
    EXPECT_LE(largest_error(r, load), fault.cost * error + 0.01) << "N m, without it " << error;
  }
  for (const auto& [d, marks] : clean.marks) {
    if (marks > 0) continue;
    EXPECT_EQ(r.marks.at(d), 0) << d;
  }
}

void bears_every_fault(const Robot& robot, const Trace& trace, double load, double torque) {
  Samples good;
  for (int k = 0; k < trace.size(); ++k) {
    good.push_back({trace.t[k], trace.q.col(k), trace.qd.col(k), trace.tau.col(k)});
  }
  int pairs = 0;
  for (const std::string& e : robot.estimators()) {
    if (is_baseline(e) || printed_form(e)) continue;
    const Run clean = run(robot, e, good);
    for (const auto& [d, marks] : clean.marks) pairs += marks == 0;
    for (const Fault<Sample>& fault : faults<Sample>(robot.dof() / 2, torque)) {
      for (const int at : {kFault, kSlow}) {
        // there, but frozen sensors; q or qd alone hardly differs from what it would be
        if (at == kSlow && (fault.samples < 50 || fault.name[0] == 'q')) continue;
        SCOPED_TRACE(fmt::format("{} {}: {} at {}", robot.name(), e, fault.name, at));
        bears(robot, e, fault, at, good, clean, load);
      }
    }
  }
  EXPECT_GE(pairs, 30) << "too few pairs without a mark in what is no collision";
}

TEST(Faults, AreBorneByEveryPairOnWallmobot3) {
  const Robot& arm = robot("wallmobot3");
  bears_every_fault(arm, moving(load_robot("wallmobot3"), 20), 20, 1e4);
}

TEST(Faults, AreBorneByEveryPairOnTestbed1) {
  const Robot& arm = robot("testbed1");
  bears_every_fault(arm, moving(load_robot("testbed1"), 5), 5, 1e3);
}

class FaultsOfAFile : public testing::TestWithParam<int> {};

TEST_P(FaultsOfAFile, AreBorneByEveryPair) {
  const HingeRobot arm(GetParam());
  bears_every_fault(*arm.robot, moving(arm.model, 0.1), 0.1, 1e3);
}
INSTANTIATE_TEST_SUITE_P(SixAndSevenJoints, FaultsOfAFile, testing::Values(6, 7),
                         [](const auto& i) { return fmt::format("{}_joints", i.param); });

}  // namespace
}  // namespace tauext::test
