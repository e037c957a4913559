// SPDX-License-Identifier: Apache-2.0
// A trace that no simulator made.
#pragma once

#include <cmath>

#include "mjcf/trace/trace.h"

namespace tauext::test {

// numbers that need all their digits, with truth and contact
inline Trace some_trace(int dof, int samples) {
  Trace t;
  for (auto* m : {&t.q, &t.qd, &t.tau, &t.tau_ext}) m->resize(dof, samples);
  for (int k = 0; k < samples; ++k) {
    t.t.push_back(1e-3 * k);
    t.contact.push_back(k % 7 == 3);
    for (int j = 0; j < dof; ++j) {
      const double phase = 0.01 * k + j;
      t.q(j, k) = std::sin(phase);
      t.qd(j, k) = 1e-5 * std::cos(phase);
      t.tau(j, k) = 1e3 * std::sin(3 * phase);
      t.tau_ext(j, k) = std::exp(-phase);
    }
  }
  return t;
}

}  // namespace tauext::test
