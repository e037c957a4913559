// SPDX-License-Identifier: Apache-2.0
// What the lists of fields promise of every estimator and detector.
#include "estimators/parameters.h"

#include <gtest/gtest.h>

#include <string>

#include "estimators/active_observer.h"
#include "estimators/detectors/band_pass.h"
#include "estimators/detectors/contact_classifier.h"
#include "estimators/detectors/cusum.h"
#include "estimators/detectors/dynamic_threshold.h"
#include "estimators/detectors/energy.h"
#include "estimators/detectors/glr.h"
#include "estimators/detectors/high_pass.h"
#include "estimators/detectors/threshold.h"
#include "estimators/disturbance_kalman_filter.h"
#include "estimators/ekf.h"
#include "estimators/extended_state_observer.h"
#include "estimators/higher_order_momentum_observer.h"
#include "estimators/inverse_dynamics.h"
#include "estimators/momentum_observer.h"
#include "estimators/ndob.h"
#include "estimators/ndob_inertia.h"
#include "estimators/sliding_mode_observer.h"
#include "estimators/test/arm.h"
#include "estimators/wallmobot3.h"
#include "mjcf/test/error_of.h"

namespace tauext::test {
namespace {

// sets the field beyond its limits in every way and builds T of it; the number of ways that were
// refused
template <class T, class P, class Value, class Build>
int refused(const Field<P, Value>& f, const P& good, Build&& build) {
  int count = 0;
  if constexpr (!std::is_enum_v<Value>) {
    for (const double bad : {f.least - 1, 2 * f.most + 1, std::is_same_v<Value, int> ? -1 : kNaN}) {
      P p = good;
      if constexpr (std::is_arithmetic_v<Value>) {
        p.*f.at = static_cast<Value>(bad);
      } else {
        (p.*f.at)[(p.*f.at).size() - 1] = bad;
      }
      const std::string why = error_of([&] { build(p); });
      const std::string begin = std::string(f.key) + " [" + f.unit + "] of " + T::kName + " is ";
      EXPECT_EQ(why.substr(0, begin.size()), begin);
      ++count;
    }
  }
  return count;
}
template <class T, class P, class Inner, class Build>
int refused(const Nested<P, Inner>&, const P&, Build&&) {
  return 0;
}

// all fields of T's parameters
template <class T, class Build>
int all_refused(const typename T::Parameters& good, Build&& build) {
  EXPECT_EQ(error_of([&] { build(good); }), "no error") << T::kName;
  int count = 0;
  for_each_field<typename T::Parameters>(
      [&](const auto& f) { count += refused<T>(f, good, build); });
  return count;
}

// a design of the widest limits, too
template <class E>
int of_estimator(double most = kMostBandwidth) {
  const WallMoBot3 arm;
  int count = 0;
  for (const double w : {kLeastBandwidth, 30., most}) {
    count = all_refused<E>(E::Parameters::for_bandwidth(arm, w), [&](const auto& p) { E(arm, p); });
  }
  return count / 3;
}

template <class D>
int of_detector() {
  return all_refused<D>({}, [](const auto& p) { D(3, p); }) / 3;
}

// so many fields hold numbers
TEST(Parameters, OfEveryEstimatorAreRefusedBeyondTheirLimitsByName) {
  using M = WallMoBot3;
  EXPECT_EQ(of_estimator<InverseDynamics<M>>(), 2);
  EXPECT_EQ(of_estimator<MomentumObserver<M>>(), 2);
  EXPECT_EQ(of_estimator<MomentumObserver2<M>>(), 2);
  EXPECT_EQ(of_estimator<MomentumObserver3<M>>(), 2);
  EXPECT_EQ(of_estimator<NdobInertia<M>>(), 2);
  EXPECT_EQ(of_estimator<Ndob<M>>(), 2);
  EXPECT_EQ(of_estimator<DisturbanceKalmanFilter<M>>(), 7);
  EXPECT_EQ(of_estimator<ExtendedStateObserver<M>>(kMostBandwidth / 2), 2) << "poles of 1.96 w";
  EXPECT_EQ(of_estimator<SlidingModeObserver<M>>(), 5);
  EXPECT_EQ(of_estimator<ActiveObserver<M>>(), 6);
  EXPECT_EQ(of_estimator<Ekf<M>>(), 7);
}

TEST(Parameters, OfEveryDetectorAreRefusedBeyondTheirLimitsByName) {
  EXPECT_EQ(of_detector<Threshold>(), 3);
  EXPECT_EQ(of_detector<DynamicThreshold>(), 5);
  EXPECT_EQ(of_detector<HighPass>(), 4);
  EXPECT_EQ(of_detector<BandPass>(), 5);
  EXPECT_EQ(of_detector<Cusum>(), 6);
  EXPECT_EQ(of_detector<Glr>(), 5);
  EXPECT_EQ(of_detector<Energy>(), 4);
  EXPECT_EQ(of_detector<Clamping>(), 6);
  EXPECT_EQ(of_detector<PanTompkins>(), 5);
  EXPECT_EQ(of_detector<ContactClassifier>(), 2);
}

TEST(Parameters, SayWhatIsWrongWithThem) {
  EXPECT_EQ(error_of([] { HighPass(3, {.w = 0}); }),
            "w [rad/s] of high_pass is 0: it must be 0.001 to 1e+06");
  EXPECT_EQ(error_of([] { BandPass(3, {.w_low = 100, .w_high = 10}); }),
            "w_low of band_pass must be below w_high");
  ContactClassifier::Parameters nested;
  nested.clamping.duration = -1;
  EXPECT_EQ(error_of([&] { ContactClassifier(3, nested); }),
            "duration [s] of clamping is -1: it must be 1e-06 to 1000");
}

}  // namespace
}  // namespace tauext::test
