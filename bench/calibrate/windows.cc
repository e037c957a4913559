// SPDX-License-Identifier: Apache-2.0
#include "bench/calibrate/windows.h"

#include <fmt/format.h>

#include <cmath>
#include <stdexcept>

namespace tauext {
namespace {

constexpr double kLongestGap = 0.05;    // [s]
constexpr double kNextToAWindow = 0.2;  // [1] of its length

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

double weight(const Trace& log, const Window& w, int k) {
  const auto sum_before = [&](int sample) {
    const double s = (log.t[sample] - log.t[w.first]) / (log.t[w.second] - log.t[w.first]);
    return s * s * (3 - 2 * s);
  };
  return sum_before(k + 1) - sum_before(k);
}

std::pair<Window, Window> around(const Trace& log, const Window& w) {
  const double T = log.t[w.second] - log.t[w.first], near = kNextToAWindow * T;
  // from w's end in steps of 1 or -1 to the sample that is T away, or nowhere
  const auto part = [&](int from, int step) {
    int k = from, begin = -1;
    const auto away = [&] { return std::abs(log.t[k] - log.t[from]); };
    while (away() < T * (1 - 1e-9)) {
      const int next = k + step;
      if (next < 0 || next >= log.size() || std::abs(log.t[next] - log.t[k]) > kLongestGap)
        return Window{0, 0};
      k = next;
      if (begin < 0 && away() >= near) begin = k;
    }
    return step > 0 ? Window{begin, k + 1} : Window{k, begin + 1};
  };
  const Window before = part(w.first, -1), after = part(w.second, 1);
  if (before.second == 0 || after.second == 0) return {};
  return {before, after};
}

double mean_torque(const Trace& log, int joint, const Window& w) {
  if (log.torque_at_instants) return mean_over(log, w, [&](int k) { return log.tau(joint, k); });
  double sum = 0;
  for (int k = w.first; k < w.second; ++k) sum += weight(log, w, k) * log.tau(joint, k);
  return sum;
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
