// SPDX-License-Identifier: Apache-2.0
#include "bench/replay/torque_delay.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <map>
#include <optional>
#include <vector>

namespace tauext {
namespace {

constexpr double kLate = 0.015;      // [s] less may be a filter's
constexpr double kSureOfDelay = 25;  // as kSure, as masses that err look like a delay, too

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
constexpr std::size_t kBeside = 2;  // windows before one, and behind it
using Neighbours = std::array<const ArmWindow*, 2 * kBeside + 1>;

// Those that two windows touch before them and two behind them, with these; all of as many steps as
// most of them, as where samples jitter some have fewer.
std::vector<Neighbours> with_neighbours(const ArmWindows& windows) {
  std::vector<Neighbours> all;
  std::map<Index, int> counts;
  for (const ArmWindow& w : windows) ++counts[w.steps.cols()];
  const auto usual =
      std::max_element(counts.begin(), counts.end(),
                       [](const auto& a, const auto& b) { return a.second < b.second; });
  const auto touch = [&](const ArmWindow& a, const ArmWindow& b) {
    return a.motion(0, a.motion.cols() - 1) == b.motion(0, 0) && a.steps.cols() == usual->first &&
           b.steps.cols() == usual->first;
  };
  for (std::size_t last = 2 * kBeside; last < windows.size(); ++last) {
    Neighbours some;
    bool all_touch = true;
    for (std::size_t i = 0; i < some.size(); ++i) {
      some[i] = &windows[last - 2 * kBeside + i];
      all_touch = all_touch && (i == 0 || touch(*some[i - 1], *some[i]));
    }
    if (all_touch) all.push_back(some);
  }
  return all;
}

// [N m] of the torque so many steps later
double later(const Neighbours& some, int j, Index steps) {
  const ArmWindow& own = *some[kBeside];
  const Index count = own.steps.cols(), before = static_cast<Index>(kBeside) * count;
  double sum = 0;
  for (Index k = before + steps; k < before + count + steps; ++k)
    sum += some[static_cast<std::size_t>(k / count)]->steps(j, k % count);
  return sum / (own.motion(0, count) - own.motion(0, 0));
}

// of one joint, what each delay leaves unexplained
struct JointDelays {
  VectorXd left;         // [(N m)^2]
  VectorXd independent;  // windows
  double by_factor = 0;  // [(N m)^2] what a factor leaves in the place of a delay
};

JointDelays delays_of(const std::vector<Neighbours>& all, int j) {
  const Index most = static_cast<Index>(kBeside) * all.front()[kBeside]->steps.cols(),
              count = static_cast<Index>(all.size());
  std::vector<const ArmWindow*> windows;
  for (const Neighbours& some : all) windows.push_back(some[kBeside]);
  const VectorXd model = each(windows, [j](const ArmWindow& w) { return w.model[j]; });
  MatrixXd others(count, 3);  // a rotor, masses, an offset
  others << rotor_torque(windows, j),
      each(windows, [j](const ArmWindow& w) { return w.gravity[j]; }), VectorXd::Ones(count);
  JointDelays found{VectorXd(2 * most + 1), VectorXd(2 * most + 1)};
  for (Index by = -most; by <= most; ++by) {
    VectorXd tau(count);
    for (Index i = 0; i < count; ++i) tau[i] = later(all[static_cast<std::size_t>(i)], j, by);
    const double varies = (tau.array() - tau.mean()).square().mean();
    const double negligible = kNegligible * varies + 1e-300;
    const WindowFit f = fit(windows, j, tau - model, others);
    found.left[most + by] = f.mean_square + negligible;
    found.independent[most + by] = independent(f.residual);
    if (by != 0) continue;
    MatrixXd more(count, 2);
    more << model, VectorXd::Ones(count);
    WindowFit by_factor = fit(windows, j, tau - model, more);
    undo_noise(by_factor, 1 + by_factor.multiples[0]);
    found.by_factor = by_factor.mean_square + negligible;
  }
  return found;
}

// the delay [steps] that explains the joints best, if that is no chance, it is worth it in one of
// them, and no factor does as well; at the end of those that were tried it is none, as then
// anything else may be the cause
std::optional<Index> delay_of(const std::vector<JointDelays>& joints) {
  const Index most = joints.front().left.size() / 2;
  VectorXd sum = VectorXd::Zero(2 * most + 1);
  for (const JointDelays& j : joints) sum += j.left.array().log().matrix();
  Index best = 0;
  const double least = sum.minCoeff(&best);
  double likelihood = 0, improvement = 0, by_factor = 0;
  for (const JointDelays& j : joints) {
    const double ratio = j.left[most] / j.left[best];
    likelihood += j.independent[best] / 2 * std::log(ratio);
    improvement = std::max(improvement, ratio);
    by_factor += std::log(j.by_factor);
  }
  if (likelihood < kSureOfDelay || improvement < kMinImprovement || by_factor <= least ||
      std::abs(best - most) == most)
    return std::nullopt;
  return best - most;
}

}  // namespace

std::string found_delay(const ArmTree& arm, const WindowMaker& recording) {
  const auto all = with_neighbours(recording.windows());
  if (all.size() < kFewestWindows) return "";
  const ArmWindow& one = *all.front()[kBeside];
  const Index steps = one.steps.cols();
  const double step = (one.motion(0, steps) - one.motion(0, 0)) / static_cast<double>(steps);
  std::vector<JointDelays> joints;
  for (int j = 0; j < arm.dof(); ++j) joints.push_back(delays_of(all, j));
  const double late = step * static_cast<double>(delay_of(joints).value_or(0));
  if (std::abs(late) < kLate) return "";
  return fmt::format(
      "tau comes {:.0f} ms {} the motion that takes it: are both stamped by one clock, and for the "
      "time when they were measured?",
      1000 * std::abs(late), late > 0 ? "after" : "before");
}

}  // namespace tauext
