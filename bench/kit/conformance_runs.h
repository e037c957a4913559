// SPDX-License-Identifier: Apache-2.0
/// @file
/// The claim of bench/kit/conformance.h on estimators that can do several runs at once
/// (estimators/runs/runs.h).
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <vector>

#include "estimators/runs/runs.h"

namespace tauext::conformance {

/// An estimator of arms of this model that can do several runs at once.
template <class E, class M>
concept ForRunsOf = ForRuns<E> && std::same_as<typename E::Model, M>;

/// Samples of W runs.
template <int N, int W>
using SamplesOfRuns = std::array<std::vector<Measurement<N>>, static_cast<std::size_t>(W)>;

/// Each of W runs has the statuses and joints of an estimator that is alone, and its estimates
/// within 1e-12 of the largest tau or tau_ext [N m], whose differences they are. A run that ends
/// early repeats its last sample.
/// @returns how many samples were left out, started or put right, of all runs
template <ForRuns E, int W>
int expect_runs_alike(const typename E::Model& arm,
                      const std::array<typename E::Parameters, static_cast<std::size_t>(W)>& p,
                      const SamplesOfRuns<E::kDof, W>& samples) {
  constexpr int N = E::kDof;
  Runs<E, W> runs(arm, p);
  std::vector<E> alone;
  for (const auto& of_run : p) alone.emplace_back(arm, of_run);
  std::size_t length = 0;
  for (const auto& s : samples) length = std::max(length, s.size());
  int odd = 0;
  double scale = 0, off = 0;
  std::ptrdiff_t where[3] = {};  // sample, run and joint that are off most
  for (std::size_t k = 0; k < length; ++k) {
    Measurement<N, Pack<W>> y;
    for (int i = 0; i < W; ++i) {
      const auto& mine = samples[static_cast<std::size_t>(i)];
      put(mine[std::min(k, mine.size() - 1)], i, y);
    }
    const RunsEstimate<N, W>& all = runs.update(y);
    for (int i = 0; i < W; ++i) {
      const auto at = static_cast<std::size_t>(i);
      const Measurement<N>& mine = samples[at][std::min(k, samples[at].size() - 1)];
      const Estimate<N> e = alone[at].update(mine);
      if (all.status[at] != e.status || all.joints[at] != e.joints) {
        ADD_FAILURE() << "run " << i << ", sample " << k << ": " << name_of(all.status[at])
                      << ", alone " << name_of(e.status)
                      << ": does memory() list its Sampling first?";
        return odd;
      }
      odd += e.status != Status::kOk || e.joints != 0;
      scale = std::max(scale, e.tau_ext.cwiseAbs().maxCoeff());
      if (used(e.status)) scale = std::max(scale, mine.tau.cwiseAbs().maxCoeff());
      for (int j = 0; j < N; ++j) {
        const double apart = std::abs(all.tau_ext[j][i] - e.tau_ext[j]);
        if (apart <= off) continue;
        off = apart;
        where[0] = static_cast<std::ptrdiff_t>(k), where[1] = i, where[2] = j;
      }
    }
  }
  EXPECT_LE(off, 1e-12 * scale) << "N m of joint " << where[2] + 1 << " in run " << where[1]
                                << ", sample " << where[0]
                                << ": does memory() list all that update() remembers?";
  return odd;
}

}  // namespace tauext::conformance
