// SPDX-License-Identifier: Apache-2.0
/// @file
/// A log in windows of time, over which equation (3) is integrated.
#pragma once

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

/// @throws std::invalid_argument for a length or a speed that is none
void check_windows(const Windows& w);

/// What to say where too few windows can be used.
std::string too_few(std::size_t usable, std::size_t needed, int left_out, const Windows& w);

}  // namespace tauext
