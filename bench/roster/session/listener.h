// SPDX-License-Identifier: Apache-2.0
/// @file
/// From a detector's answers at every sample to what a study asks of them.
#pragma once

#include <array>
#include <cstddef>
#include <iterator>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "bench/roster/session/answers.h"
#include "estimators/detectors/marking.h"

namespace tauext::detail {

// a number, or what a comparison says, of run i
template <class Numbers>
auto of_run(const Numbers& x, int i) {
  if constexpr (requires { x[i]; }) {
    return x[i];
  } else {
    return x;
  }
}

// runs that a number is of
template <class Scalar>
constexpr int width_of() {
  if constexpr (requires { Scalar::kWidth; }) {
    return Scalar::kWidth;
  } else {
    return 1;
  }
}

// What detectors of runs say, sample by sample. Almost every score stays between the two levels
// that the last one was between, so one comparison for all runs is enough.
template <class Scalar>
class Listener {
 public:
  Listener(std::span<const double> levels, double from) : levels_(levels), from_(from) {
    for (Answers& a : answers_) a.rises.resize(levels.size());
    above_.fill(levels.size());
  }

  [[gnu::always_inline]] void take(double t, const DetectionOf<Scalar>& d) {
    if (t >= from_) {
      ++samples_;
      alarmed_ += select(d.score >= 1, Scalar(1), Scalar(0));
    }
    if (!all((d.score >= low_) & (d.score < high_) & !d.mark)) look(t, d);
  }

  // of each run
  std::vector<Answers> answers() && {
    for (int i = 0; i < kWidth; ++i) {
      at(i).samples = samples_;
      at(i).alarmed = static_cast<long>(of_run(alarmed_, i));
    }
    return {std::make_move_iterator(answers_.begin()), std::make_move_iterator(answers_.end())};
  }

 private:
  static constexpr int kWidth = width_of<Scalar>();
  static constexpr double kInfinity = std::numeric_limits<double>::infinity();

  Answers& at(int i) { return answers_[static_cast<std::size_t>(i)]; }

  [[gnu::noinline]] void look(double t, const DetectionOf<Scalar>& d) {
    for (int i = 0; i < kWidth; ++i) {
      const double score = of_run(d.score, i);
      rise(t, score, at(i), above_[static_cast<std::size_t>(i)]);
      if (t >= from_ && of_run(d.mark, i))
        at(i).marks.push_back({t, static_cast<Contact>(of_run(d.contact, i))});
      bound(i, above_[static_cast<std::size_t>(i)]);
    }
  }

  // `above`: the first level above the score; nothing rises at first
  void rise(double t, double score, Answers& to, std::size_t& above) {
    for (; above < levels_.size() && score >= levels_[above]; ++above) {
      std::vector<double>& at = to.rises[above];
      if (t >= from_ && (at.empty() || t - at.back() >= Answers::kApart)) at.push_back(t);
    }
    while (above > 0 && !(score >= levels_[above - 1])) --above;
  }

  void bound(int i, std::size_t above) {
    const double low = above == 0 ? -kInfinity : levels_[above - 1];
    const double high = above == levels_.size() ? kInfinity : levels_[above];
    if constexpr (kWidth == 1) {
      low_ = low, high_ = high;
    } else {
      low_.set(i, low), high_.set(i, high);
    }
  }

  std::span<const double> levels_;
  double from_;
  long samples_ = 0;
  Scalar alarmed_ = 0;
  Scalar low_ = kInfinity, high_ = -kInfinity;  // no score is between: the first is looked at
  std::array<std::size_t, kWidth> above_;
  std::array<Answers, kWidth> answers_;
};

}  // namespace tauext::detail
