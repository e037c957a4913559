// SPDX-License-Identifier: Apache-2.0
#include "bench/calibrate/windows.h"

#include <fmt/format.h>

#include <cmath>
#include <stdexcept>

namespace tauext {
namespace {

constexpr double kLongestGap = 0.05;  // [s]

bool usable(const Trace& log, int joint, const Window& w, double min_speed) {
  const auto [a, b] = w;
  const bool forward = log.qd(joint, a) > 0;
  for (int k = a; k <= b; ++k) {
    const double qd = log.qd(joint, k);
    if (std::abs(qd) < min_speed || (qd > 0) != forward) return false;
    if (!log.contact.empty() && log.contact[static_cast<std::size_t>(k)] != 0) return false;
    if (k > a && log.t[k] - log.t[k - 1] > kLongestGap) return false;
  }
  return true;
}

}  // namespace

std::vector<Window> windows_of(const Trace& log, int joint, const Windows& w, int& left_out) {
  std::vector<Window> all;
  for (int a = 0; a + 1 < log.size();) {
    int b = a + 1;
    while (b + 1 < log.size() && log.t[b] - log.t[a] < w.length * (1 - 1e-9)) ++b;
    if (log.t[b] - log.t[a] < w.length * (1 - 1e-9)) break;  // the rest is no whole window
    if (usable(log, joint, {a, b}, w.min_speed)) {
      all.emplace_back(a, b);
    } else {
      ++left_out;
    }
    a = b;
  }
  return all;
}

double mean_torque(const Trace& log, int joint, const Window& w) {
  if (log.torque_at_instants) return mean_over(log, w, [&](int k) { return log.tau(joint, k); });
  double sum = 0;
  for (int k = w.first; k < w.second; ++k) sum += (log.t[k + 1] - log.t[k]) * log.tau(joint, k);
  return sum / (log.t[w.second] - log.t[w.first]);
}

double mean_acceleration(const Trace& log, int joint, const Window& w) {
  return (log.qd(joint, w.second) - log.qd(joint, w.first)) / (log.t[w.second] - log.t[w.first]);
}

void check_windows(const Windows& w) {
  if (w.length > 0 && w.length <= 10 && w.min_speed >= 0 && std::isfinite(w.min_speed)) return;
  throw std::invalid_argument(fmt::format(
      "window of {} s, min_speed {} rad/s: 0 to 10 s, and not negative", w.length, w.min_speed));
}

std::string too_few(std::size_t usable, std::size_t needed, int left_out, const Windows& w) {
  return fmt::format(
      "{} usable windows of {} s, at least {} are needed; {} were left out as slower than {} "
      "rad/s, as touched or across a gap: record more motion, both ways",
      usable, w.length, needed, left_out, w.min_speed);
}

}  // namespace tauext
