// SPDX-License-Identifier: Apache-2.0
#include "mjcf/trace/read/regularity.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace tauext {

std::string Regularity::in_words() const {
  std::string all = fmt::format("{} samples in {:.6g} s, one every {:.4g} ms (+- {:.2g} ms)",
                                samples, to - from, 1000 * step,
                                jitter < 1e-6 * step ? 0 : 1000 * jitter);  // not rounding's
  if (gaps > 0)
    all += fmt::format(", {} gap{}, the longest {:.3g} s", gaps, gaps == 1 ? "" : "s", longest_gap);
  if (repeats > 0) all += fmt::format(", {} of them repeat the one before", repeats);
  return all;
}

void RegularityCounter::take(double t, const Eigen::VectorXd& q, const Eigen::VectorXd& qd,
                             const Eigen::VectorXd& tau) {
  if (r_.samples++ == 0) {
    r_.from = t;
  } else {
    take_step(t - r_.to);
    r_.repeats += q == q_ && qd == qd_ && tau == tau_;
  }
  r_.to = t;
  q_ = q, qd_ = qd, tau_ = tau;
}

void RegularityCounter::take_step(double h) {
  constexpr std::int64_t kSteps = 3;     // in a row are no gaps
  if (steps_ == 1 && 8 * h < r_.step) {  // the first one was a gap
    ++r_.gaps;
    r_.longest_gap = r_.step;
    steps_ = 0;
    r_.step = squares_ = 0;
  }
  if (steps_ > 0 && h > 8 * r_.step) {
    if (in_a_row_++ == 0) longest_before_ = r_.longest_gap;
    ++r_.gaps;
    r_.longest_gap = std::max(r_.longest_gap, h);
    if (in_a_row_ < kSteps) return;
    r_.gaps -= in_a_row_;  // so that is how far samples are apart now
    r_.longest_gap = longest_before_;
    steps_ = 0;
    r_.step = squares_ = 0;
  }
  in_a_row_ = 0;
  ++steps_;  // Welford's sums
  const double off = h - r_.step;
  r_.step += off / static_cast<double>(steps_);
  squares_ += off * (h - r_.step);
  r_.jitter = std::sqrt(squares_ / static_cast<double>(steps_));
}

}  // namespace tauext
