// SPDX-License-Identifier: Apache-2.0
/// @file
/// A log in windows of time, over which equation (3) is integrated.
#pragma once

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "mjcf/trace/trace.h"

namespace tauext {

/// How a log is cut into windows.
struct Windows {
  double length = 0.1;      ///< [s] longer: less noise, less of a fast motion
  double min_speed = 0.02;  ///< [rad/s] above the slip at which dry friction is full, and the noise
};

/// Samples of one, from the first to the one where the next begins.
using Window = std::pair<int, int>;

/// The windows of a log, one behind the other, in which a joint moves one way all the time, without
/// a contact that the log knows of, or a gap of 0.05 s.
/// @param left_out counts the others
std::vector<Window> windows_of(const Trace& log, int joint, const Windows& w, int& left_out);

/// The mean over a window of f(k), known at each sample k, by the trapezium rule.
template <class F>
double mean_over(const Trace& log, const Window& w, F&& f) {
  double sum = 0, at = f(w.first);
  for (int k = w.first; k < w.second; ++k) {
    const double next = f(k + 1);
    sum += (log.t[k + 1] - log.t[k]) * (at + next) / 2;
    at = next;
  }
  return sum / (log.t[w.second] - log.t[w.first]);
}

/// [N m] the mean of a joint's torque, as the log has it: held, or read at instants.
double mean_torque(const Trace& log, int joint, const Window& w);

/// [rad/s^2] the mean of a joint's acceleration.
double mean_acceleration(const Trace& log, int joint, const Window& w);

/// @throws std::invalid_argument for a length or a speed that is none
void check_windows(const Windows& w);

/// What to say where too few windows can be used.
std::string too_few(std::size_t usable, std::size_t needed, int left_out, const Windows& w);

}  // namespace tauext
