// SPDX-License-Identifier: Apache-2.0
#include "mjcf/record_plain.h"

#include <algorithm>
#include <limits>

namespace tauext {

double difference(const Trace& a, const Trace& b) {
  if (a.t != b.t) return std::numeric_limits<double>::infinity();
  double largest = 0;
  for (const auto of :
       {&Trace::q, &Trace::qd, &Trace::qdd, &Trace::tau, &Trace::tau_ext, &Trace::friction}) {
    const double size = std::max((a.*of).cwiseAbs().maxCoeff(), 1e-3);
    largest = std::max(largest, (a.*of - b.*of).cwiseAbs().maxCoeff() / size);
  }
  return largest;
}

}  // namespace tauext
