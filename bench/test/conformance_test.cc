// SPDX-License-Identifier: Apache-2.0
// What every estimator and detector of the roster must do, whoever wrote it; and that these checks can fail.
#include "bench/conformance.h"

#include <gtest/gtest-spi.h>
#include <gtest/gtest.h>

#include <memory>
#include <vector>

#include "bench/robot.h"
#include "bench/roster.h"
#include "bench/suite.h"
#include "estimators/test/arm.h"
#include "mjcf/record.h"

namespace tauext::test {
namespace {

// calls claim(make) for every kind that estimates; baselines only know their trace
template <class Arm, class Claim>
int for_every_estimator(Claim&& claim) {
  int count = 0;
  for_each_estimator(Arm(), [&](auto make) {
    using E = decltype(make(Trace()));
    if (is_baseline(E::kName)) return;
    claim([make] { return make(Trace()); });
    ++count;
  });
  return count;
}

template <class Arm>
class EveryEstimator : public testing::Test {};
using Arms = testing::Types<WallMoBot3, Testbed1>;
TYPED_TEST_SUITE(EveryEstimator, Arms);

TEST(EveryRobot, IsHeldToTheseTests) {
  int robots = 0;
  for_each_robot([&](const char*, const auto&) { ++robots; });
  EXPECT_EQ(robots, 2) << "add the new one to Arms above";
}

TYPED_TEST(EveryEstimator, Conforms) {
  const int count = for_every_estimator<TypeParam>(
      [](auto make) { conformance::check_estimator(TypeParam(), make); });
  EXPECT_GE(count, 10);
}

TEST(EveryEstimatorOfWallMoBot3, EstimatesAForceOnThePanelAsMinusJTransposeF) {
  Scenario s = scenario("wallmobot3", "free");
  s.duration = 12;
  s.force = [](double, const Point&) -> Eigen::Vector3d { return {50, 0, 0}; };
  const Trace t = record(load_robot("wallmobot3"), s);
  const Vec<3> truth = -WallMoBot3().jacobian(t.q.col(t.size() - 1)).transpose() * Vec<3>(50, 0, 0);
  for_every_estimator<WallMoBot3>([&](auto make) {
    auto e = make();
    Vec<3> last;
    for (int k = 0; k < t.size(); ++k) last = e.update(t.measurement<3>(k)).tau_ext;
    EXPECT_LT((last - truth).cwiseAbs().maxCoeff(), 0.05 * truth.norm())
        << e.kName << " " << last.transpose();
  });
}

// within 0.1 N m in the last second after a step of 98.2 N m, which every estimator has had 29 s for
TEST(EveryEstimatorOfWallMoBot3, EndsUpAtTheLoadAfterAStep) {
  for (const Entry& e : entries()) {
    if (e.group() != "wallmobot3/step" || is_baseline(e.estimator)) continue;
    static Suite suite{SuiteOptions{}};
    EXPECT_LE(*suite.score(e).get("final_Nm"), 0.1) << e.name();
  }
}

TEST(EveryDetector, Conforms) {
  int count = 0;
  const auto check = [&](auto make) {
    conformance::check_detector(make);
    ++count;
  };
  for_each_detector<3>(check);
  for_each_detector<1>(check);
  EXPECT_EQ(count, 16);
}

// ---- estimators and a detector that are wrong, each in its own way

using Mo1 = MomentumObserver<WallMoBot3>;

struct WrongSign : Mo1 {
  WrongSign() : Mo1(WallMoBot3()) {}
  Estimate<3> update(const Measurement<3>& y) noexcept {
    Estimate<3> e = Mo1::update(y);
    e.tau_ext = -e.tau_ext;
    return e;
  }
};

struct Allocates : Mo1 {
  Allocates() : Mo1(WallMoBot3()) {}
  Estimate<3> update(const Measurement<3>& y) noexcept {
    const auto copy = std::make_unique<std::vector<double>>(y.q.begin(), y.q.end());
    return Mo1::update(copy->empty() ? Measurement<3>() : y);
  }
};

struct TakesNaN : Mo1 {
  TakesNaN() : Mo1(WallMoBot3()) {}
  Estimate<3> update(const Measurement<3>& y) noexcept {
    return y.q.allFinite() && y.qd.allFinite() && y.tau.allFinite() ? Mo1::update(y)
                                                                    : Estimate<3>{Vec<3>::Zero()};
  }
};

struct BelievesInAMillisecond : Mo1 {
  BelievesInAMillisecond() : Mo1(WallMoBot3(), {.K = Vec<3>::Constant(5)}) {}
  Estimate<3> update(const Measurement<3>& y) noexcept {
    return Mo1::update({1e-3 * k_++, y.q, y.qd, y.tau});
  }
  int k_ = 0;
};

int shared = 0;
struct SharesItsState : Mo1 {
  SharesItsState() : Mo1(WallMoBot3()) {}
  Estimate<3> update(const Measurement<3>& y) noexcept {
    Estimate<3> e = Mo1::update(y);
    e.tau_ext[0] += 1e-9 * ++shared;
    return e;
  }
};

// the failures of a claim
template <class Claim>
int failures(Claim&& claim) {
  testing::TestPartResultArray results;
  {
    testing::ScopedFakeTestPartResultReporter reporter(
        testing::ScopedFakeTestPartResultReporter::INTERCEPT_ONLY_CURRENT_THREAD, &results);
    claim();
  }
  int failed = 0;
  for (int i = 0; i < results.size(); ++i) failed += results.GetTestPartResult(i).failed();
  return failed;
}

template <class E>
auto claims() {
  const auto make = [] { return E(); };
  return conformance::EstimatorClaims<WallMoBot3, decltype(make)>(WallMoBot3(), make);
}

TEST(Conformance, FindsWhatIsWrongWithAnEstimator) {
  EXPECT_GT(failures([] { claims<WrongSign>().has_the_sign_of_equation_3(); }), 0);
  EXPECT_GT(failures([] { claims<WrongSign>().ends_up_at_a_step(); }), 0);
  if (allocations_are_counted()) {
    EXPECT_GT(failures([] { claims<Allocates>().allocates_nothing(); }), 0);
  }
  EXPECT_GT(failures([] { claims<TakesNaN>().flags_a_bad_sample_holds_and_recovers(); }), 0);
  EXPECT_GT(failures([] { claims<BelievesInAMillisecond>().answers_alike_at_every_sample_time(); }),
            0);
  EXPECT_GT(failures([] { claims<SharesItsState>().repeats_itself_alone_and_in_company(); }), 0);
}

// marks every tenth of a second, whatever happens
struct Nervous {
  static constexpr const char* kName = "nervous";
  static constexpr int kDof = 3;
  void reset() noexcept {}
  Detection update(double t, const Vec<3>&) noexcept {
    const bool mark = std::fmod(t, 0.1) < 1e-3;
    return {mark, mark ? 0.5 : 0, Contact::kCollision};
  }
};

TEST(Conformance, FindsWhatIsWrongWithADetector) {
  const auto make = [] { return Nervous(); };
  const conformance::DetectorClaims<decltype(make)> claims(make);
  EXPECT_GT(failures([&] { claims.leaves_rest_in_peace(); }), 0);
  EXPECT_GT(failures([&] { claims.marks_where_its_score_reaches_one(); }), 0);
  EXPECT_GT(failures([&] { claims.ignores_bad_time_stamps(); }), 0);
}

}  // namespace
}  // namespace tauext::test
