// SPDX-License-Identifier: Apache-2.0
/// @file
/// A log in windows of time, over which equation (3) is integrated with a weight.
///
/// The weight is 6 s (1 - s) / T, with s from 0 to 1 in a window of length T: it is 0 at both ends
/// (a modulating function: Shinbrot, "On the analysis of linear and nonlinear systems", 1957), so
/// that what an acceleration is made of is every speed in the window, not the two at its ends, and
/// noise of the speed is averaged like that of the torque.
///
/// What is left of that noise is in the acceleration that multiplies an inertia, and would make the
/// inertia too small. So each change has an instrument (least_squares.h): the same change as the
/// windows before and after show it, whose noise is another one.
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

/// [1] of the time from sample k to the next; 1 in all of a window.
double weight(const Trace& log, const Window& w, int k);

/// The samples before and after a window that change_around() takes; none of both at an end of the
/// log or a gap.
std::pair<Window, Window> around(const Trace& log, const Window& w);

/// The mean over a window of f(k), known at each sample k, by the trapezium rule.
template <class F>
double mean_over(const Trace& log, const Window& w, F&& f) {
  double sum = 0, at = f(w.first);
  for (int k = w.first; k < w.second; ++k) {
    const double next = f(k + 1);
    sum += weight(log, w, k) * (at + next) / 2;
    at = next;
  }
  return sum;
}

/// The mean over a window of the derivative of f [1/s].
template <class F>
double mean_change(const Trace& log, const Window& w, F&& f) {
  double sum = 0;
  for (int k = w.first; k < w.second; ++k)
    sum += weight(log, w, k) / (log.t[k + 1] - log.t[k]) * (f(k + 1) - f(k));
  return sum;
}

/// Its instrument [1/s]: from the mean over as long before the window to that over as long behind
/// it, without the fifth of that time that is next to it, as noise of a filtered speed lasts. 0
/// where there are no such samples.
template <class F>
double change_around(const Trace& log, const Window& w, F&& f) {
  const auto [before, after] = around(log, w);
  if (before.first == before.second) return 0;
  const auto mean = [&](const Window& part, auto&& of) {
    double sum = 0;
    for (int k = part.first; k < part.second; ++k) sum += of(k);
    return sum / (part.second - part.first);
  };
  const auto time = [&](int k) { return log.t[k]; };
  return (mean(after, f) - mean(before, f)) / (mean(after, time) - mean(before, time));
}

/// [N m] the mean of a joint's torque, as the log has it: held, or read at instants.
double mean_torque(const Trace& log, int joint, const Window& w);

/// @throws std::invalid_argument for a length or a speed that is none
void check_windows(const Windows& w);

/// What to say where too few windows can be used.
std::string too_few(std::size_t usable, std::size_t needed, int left_out, const Windows& w);

}  // namespace tauext
