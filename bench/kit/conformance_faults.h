// SPDX-License-Identifier: Apache-2.0
/// @file
/// The claims of bench/kit/conformance.h on estimators whose sensors or clock fail.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <random>
#include <type_traits>
#include <vector>

#include "bench/kit/conformance_runs.h"
#include "bench/kit/faults.h"
#include "bench/kit/simulated_arm.h"
#include "estimators/samples/limits.h"

namespace tauext::conformance {

/// What an estimator of `arm` owes its user at each of faults(), one by one, on joint N / 2 of a
/// moving arm with a steady load and the noise of good sensors (1e-3 rad/s, 4.8e-5 rad).
template <RobotModel M, class Make>
class FaultClaims {
 public:
  using E = std::decay_t<std::invoke_result_t<Make>>;  ///< the estimator
  static constexpr int N = M::kDof;                    ///< joints
  using Samples = std::vector<Measurement<N>>;         ///< of a run

  /// On what make() builds for this arm.
  FaultClaims(const M& arm, Make make)
      : arm_(arm), make_(make), load_(0.1 * limits_of(arm).dtau), good_(readings(arm, load_)) {
    error_ = largest_error(run(good_));
  }

  /// A sample that is left out is said to be, and a reading that is put right; all samples are used
  /// again 25 samples after the fault; and where one sample or the clock is at fault, no estimate
  /// that is said to be good is off by more than its `cost` times what it is without the fault.
  void bears(const Fault<Measurement<N>>& fault) const {
    SCOPED_TRACE(fault.name);
    Samples bad = good_;
    fault.apply(bad, kFault);
    const auto out = run(bad);
    const auto end = kFault + static_cast<std::size_t>(fault.samples);
    bool said = false;
    for (std::size_t k = kFault; k <= end; ++k) {
      said = said || out[k].status != Status::kOk || out[k].joints != 0;
    }
    EXPECT_TRUE(said) << "neither a status nor a joint";
    for (std::size_t k = end + 25; k < out.size(); ++k) {
      ASSERT_EQ(out[k].status, Status::kOk) << k - end << " samples after the fault";
    }
    for (const auto& x : out) ASSERT_TRUE(x.tau_ext.allFinite());
    if (fault.samples == 1) {
      EXPECT_LE(largest_error(out), fault.cost * error_ + 0.01)
          << "N m; without the fault " << error_;
    }
  }

  /// Beside three other runs, of which one has this fault, too, 30 samples later, and one another
  /// load, it says the same as alone.
  void bears_in_company(const Fault<Measurement<N>>& fault) const requires ForRunsOf<E, M> {
    SCOPED_TRACE(fault.name);
    SamplesOfRuns<N, 4> samples = {good_, good_, good_, readings(arm_, -2 * load_)};
    fault.apply(samples[1], kFault);
    fault.apply(samples[2], kFault + 30);
    std::array<typename E::Parameters, 4> p;
    p.fill(made().parameters());
    expect_runs_alike<E, 4>(arm_, p, samples);
  }

  /// All of them.
  void check() const {
    SCOPED_TRACE("bears faults");
    for (const auto& f : faults<Measurement<N>>(N / 2, 1e5)) {
      bears(f);
      if constexpr (ForRunsOf<E, M>) bears_in_company(f);
    }
  }

 private:
  static constexpr std::size_t kFault = 1500;

  static Samples readings(const M& arm, const Vec<N>& load) {
    Samples all = simulated_arm::simulate<M>(
        simulated_arm::grid(2.5, 1e-3), [&](double) { return load; }, {.amplitude = 0.3, .w = 2},
        arm);
    std::mt19937_64 generator(9);
    // twelve uniform numbers, whose sum has the variance 1, in every library the same
    const auto noise = [&generator] {
      double sum = -6;
      for (int i = 0; i < 12; ++i) sum += static_cast<double>(generator() >> 11) * 0x1p-53;
      return 1e-3 * sum;
    };
    constexpr double kStep = 4.8e-5;
    for (auto& y : all) {
      for (double& x : y.q) x = kStep * std::round(x / kStep);
      for (double& x : y.qd) x += noise();
    }
    return all;
  }

  // not inlined: a copy in each claim would take long to compile
  [[gnu::noinline]] E made() const { return make_(); }
  [[gnu::noinline]] std::vector<Estimate<N>> run(const Samples& samples) const {
    E e = made();
    std::vector<Estimate<N>> out;
    for (const auto& y : samples) out.push_back(e.update(y));
    return out;
  }

  // [N m] of what was said to be good after the first second
  double largest_error(const std::vector<Estimate<N>>& out) const {
    double worst = 0;
    for (std::size_t k = 1000; k < out.size(); ++k) {
      if (out[k].status != Status::kOk) continue;
      worst = std::max(worst, (out[k].tau_ext - load_).cwiseAbs().maxCoeff());
    }
    return worst;
  }

  M arm_;
  Make make_;
  Vec<N> load_;  // [N m]
  Samples good_;
  double error_ = 0;  // [N m] without a fault
};

}  // namespace tauext::conformance
