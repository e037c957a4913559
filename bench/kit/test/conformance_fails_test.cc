// SPDX-License-Identifier: Apache-2.0
// That the checks of bench/kit/conformance.h can fail.
#include <gtest/gtest-spi.h>
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <type_traits>
#include <vector>

#include "bench/kit/conformance.h"
#include "estimators/detectors/threshold.h"
#include "estimators/momentum_observer.h"
#include "estimators/wallmobot3.h"

namespace tauext::test {
namespace {

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
    asm volatile("" : : "r"(copy->data()) : "memory");  // g++ 16 takes it out otherwise
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

// runs at once would be made of the arm that it derives from, and do without its friction
struct RubsMore : WallMoBot3 {
  Vec<3> friction(const Vec<3>& qd) const noexcept { return 50 * qd; }
};
static_assert(TorqueEstimator<MomentumObserver<RubsMore>>);
static_assert(ForRuns<Mo1> && !ForRuns<MomentumObserver<RubsMore>>);

// of an arm of several runs it would be that of one
struct Forgetful : Mo1 {
  using Mo1::Mo1;
  template <class Other>
  using For = Forgetful;
};
static_assert(TorqueEstimator<Forgetful> && !ForRuns<Forgetful>);

// marks every tenth of a second, whatever happens
struct Nervous {
  static constexpr const char* kName = "nervous";
  void reset() noexcept {}
  Detection update(double t, const JointVecView<>&) noexcept {
    const bool mark = std::fmod(t, 0.1) < 1e-3;
    return {mark, mark ? 0.5 : 0, Contact::kCollision};
  }
};

// of several runs it takes the first for all
template <class Scalar = double>
struct LooksAtOneRun {
  static constexpr const char* kName = "looks_at_one_run";
  using Parameters = ThresholdParameters;
  template <class Other>
  using For = LooksAtOneRun<Other>;
  explicit LooksAtOneRun(int joints, const Parameters& p = {}) : one_(joints, p) {}
  const Parameters& parameters() const noexcept { return one_.parameters(); }
  void reset() noexcept { one_.reset(); }
  DetectionOf<Scalar> update(double t, const JointVecView<Scalar>& tau_ext) noexcept {
    if constexpr (std::is_same_v<Scalar, double>) {
      return one_.update(t, tau_ext);
    } else {
      const JointVec<Scalar> first =
          tau_ext.unaryExpr([](const Scalar& x) { return Scalar(x[0]); });
      return one_.update(t, first);
    }
  }
  BasicThreshold<Scalar> one_;
};

TEST(Conformance, FindsADetectorThatMixesItsRuns) {
  const auto right = [] { return Threshold(3); };
  const auto wrong = [] { return LooksAtOneRun<>(3); };
  using Right = conformance::DetectorClaims<decltype(right)>;
  using Wrong = conformance::DetectorClaims<decltype(wrong)>;
  EXPECT_EQ(failures([&] { Right(right, 3).bears_company(); }), 0);
  EXPECT_GT(failures([&] { Wrong(wrong, 3).bears_company(); }), 0);
}

TEST(Conformance, FindsWhatIsWrongWithADetector) {
  const auto make = [] { return Nervous(); };
  const conformance::DetectorClaims<decltype(make)> claims(make, 3);
  EXPECT_GT(failures([&] { claims.leaves_rest_in_peace(); }), 0);
  EXPECT_GT(failures([&] { claims.marks_where_its_score_reaches_one(); }), 0);
  EXPECT_GT(failures([&] { claims.ignores_bad_time_stamps(); }), 0);
}

}  // namespace
}  // namespace tauext::test
