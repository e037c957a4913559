// SPDX-License-Identifier: Apache-2.0
/// @file
/// What goes wrong on the way from an arm's sensors to an estimator, one fault at a time, and what
/// an estimator owes its user meanwhile.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <utility>
#include <vector>

#include "estimators/samples/limits.h"

namespace tauext {

/// One fault of a recording. Sample has t, and q, qd and tau with a value for each joint.
template <class Sample>
struct Fault {
  using Samples = std::vector<Sample>;  ///< of a recording
  const char* name;                     ///< for messages
  /// What becomes of a recording from sample k on, which is at least 500 before its end.
  std::function<void(Samples&, std::size_t k)> apply;
  int samples = 1;  ///< for which it lasts at most; 1 for a new clock
  /// [1] times the largest error without it that it may cost: an observer that starts anew has the
  /// past of one sample alone, whose noise nothing takes back.
  double cost = 2;
};

namespace detail {

inline constexpr double kRestart = 6;  // times the error

template <class Sample, class Change>
Fault<Sample> once(const char* name, Change change) {
  return {name, [change](auto& s, std::size_t k) { change(s[k]); }};
}

template <class Sample, class Change>
Fault<Sample> from_then_on(const char* name, double cost, Change change) {
  return {name,
          [change](auto& s, std::size_t k) {
            for (; k < s.size(); ++k) change(s[k]);
          },
          1, cost};
}

// change(first, y) for n samples y from the first one on
template <class Sample, class Change>
Fault<Sample> for_some(const char* name, int n, Change change) {
  return {name,
          [n, change](auto& s, std::size_t k) {
            for (std::size_t i = k; i < k + n; ++i) change(s[k], s[i]);
          },
          n};
}

template <class Sample>
Fault<Sample> lost(const char* name, std::ptrdiff_t n) {
  return {name,
          [n](auto& s, std::size_t k) {
            const auto first = s.begin() + static_cast<std::ptrdiff_t>(k);
            s.erase(first, first + n);
          },
          1, kRestart};
}

inline constexpr double kNoNumber = std::numeric_limits<double>::quiet_NaN();

}  // namespace detail

/// Every fault of a clock.
template <class Sample>
std::vector<Fault<Sample>> clock_faults() {
  using Y = Sample;
  using detail::from_then_on, detail::kRestart, detail::lost, detail::once;
  return {
      once<Y>("one stamp of 1e9 s", [](Y& y) { y.t = 1e9; }),
      once<Y>("one stamp a second ahead", [](Y& y) { y.t += 1; }),
      once<Y>("one stamp 20 ms ahead", [](Y& y) { y.t += 0.02; }),
      once<Y>("one stamp an hour back", [](Y& y) { y.t -= 3600; }),
      once<Y>("one stamp that is no number", [](Y& y) { y.t = detail::kNoNumber; }),
      from_then_on<Y>("a clock set back an hour", kRestart, [](Y& y) { y.t -= 3600; }),
      from_then_on<Y>("a clock set back 5 ms", kRestart, [](Y& y) { y.t -= 0.005; }),
      from_then_on<Y>("a clock set ahead a second", kRestart, [](Y& y) { y.t += 1; }),
      from_then_on<Y>("a clock that becomes Unix time", kRestart, [](Y& y) { y.t += 1.7e9; }),
      detail::for_some<Y>("a clock that stands still for 20 samples", 20,
                          [](const Y& first, Y& y) { y.t = first.t; }),
      lost<Y>("20 samples lost", 20),
      lost<Y>("200 samples lost", 200),
  };
}

/// Every fault of a sensor, at joint j. `torque` [N m] is far beyond what the joint's motor has.
template <class Sample>
std::vector<Fault<Sample>> sensor_faults(int j, double torque) {
  using Y = Sample;
  using detail::for_some, detail::from_then_on, detail::once;
  const auto freeze = [](const Y& first, Y& y) {
    const double t = y.t;
    y = first;
    y.t = t;
  };
  return {
      once<Y>("q once 0.1 rad off", [j](Y& y) { y.q[j] += 0.1; }),
      once<Y>("q once a turn off", [j](Y& y) { y.q[j] += kTurn; }),
      from_then_on<Y>("an encoder that wraps by a turn", 2, [j](Y& y) { y.q[j] -= kTurn; }),
      once<Y>("qd once 1 rad/s off", [j](Y& y) { y.qd[j] -= 1; }),
      once<Y>("qd once 1000 rad/s off", [j](Y& y) { y.qd[j] += 1000; }),
      once<Y>("tau once far off", [j, torque](Y& y) { y.tau[j] += torque; }),
      once<Y>("tau once no number", [j](Y& y) { y.tau[j] = detail::kNoNumber; }),
      for_some<Y>("all frozen for 50 samples", 50, freeze),
      for_some<Y>("all frozen for 500 samples", 500, freeze),
      for_some<Y>("one joint frozen for 50 samples", 50,
                  [j](const Y& first, Y& y) {
                    y.q[j] = first.q[j];
                    y.qd[j] = first.qd[j];
                  }),
      for_some<Y>("q of one joint frozen for 50 samples", 50,
                  [j](const Y& first, Y& y) { y.q[j] = first.q[j]; }),
      for_some<Y>("qd of one joint frozen for 50 samples", 50,
                  [j](const Y& first, Y& y) { y.qd[j] = first.qd[j]; }),
      for_some<Y>("qd of one joint frozen for 500 samples", 500,
                  [j](const Y& first, Y& y) { y.qd[j] = first.qd[j]; }),
  };
}

/// Every fault, as above.
template <class Sample>
std::vector<Fault<Sample>> faults(int j, double torque) {
  auto all = clock_faults<Sample>();
  for (auto& f : sensor_faults<Sample>(j, torque)) all.push_back(std::move(f));
  return all;
}

}  // namespace tauext
