// SPDX-License-Identifier: Apache-2.0
#include "mjcf/record_plain.h"

#include <algorithm>
#include <limits>

namespace tauext {

double difference(const Trace& a, const Trace& b) {
  if (a.t != b.t) return std::numeric_limits<double>::infinity();
  double largest = 0;
  for (const auto of : {&Trace::q, &Trace::qd, &Trace::tau, &Trace::tau_ext}) {
    const double size = (a.*of).cwiseAbs().maxCoeff();
    const double off = (a.*of - b.*of).cwiseAbs().maxCoeff();
    largest = std::max(largest, size > 0 ? off / size : off);
  }
  return largest;
}

}  // namespace tauext
