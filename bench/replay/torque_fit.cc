// SPDX-License-Identifier: Apache-2.0
#include "bench/replay/torque_fit.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <utility>

#include "bench/replay/column_reading.h"
#include "bench/replay/torque_causes.h"
#include "bench/replay/torque_delay.h"
#include "mjcf/trace/printable.h"

namespace tauext {
namespace {

constexpr std::size_t kMinWindows = 10;
constexpr double kMinMisfit = 0.1;  // [1] of the model's mean square
constexpr double kMaxRatio = 0.1;   // [1] of mean squares: what a cause may leave unexplained
constexpr double kMaxSpreadOfGains = 1.5;  // [1] of drives that are in one arm
constexpr double kMinVariation = 1e-4;     // [1] of mean squares: less is one pose
constexpr double kMinTorqueShare = 0.05;   // [1] of a joint's usual torque, which it has to carry
constexpr double kMinVariedShare = 0.01;   // [1] of it, by which the motion makes it vary
constexpr double kOutlier = 10;            // [1] of a usual torque
constexpr double kMostlyUnknown = 0.7;     // [1] of mean squares
constexpr double kMoving = 0.5;            // [1] of the time that a joint moves one way
constexpr double kStiction = 1.2;          // [1] of its dry friction
constexpr double kSame = 1.02;             // [1] of factors that one unit has, and no masses
constexpr double kPoundFoot = 0.7375621;   // [lbf ft/(N m)]
constexpr double kMinUnit = 1.1;           // [1] and whose factor is further from 1
constexpr double kMaxRatioOfUnit = 0.01;   // [1] of mean squares, likewise
constexpr double kLight = 0.6;        // [1] of the model's torque, less than a file's masses err
constexpr std::size_t kMost = 512;    // windows, from all of the recording
constexpr double kLongRecording = 5;  // [s] which is judged by itself

using Eigen::MatrixXd;
using Eigen::VectorXd;

double mean_square(const VectorXd& y) {
  return y.squaredNorm() / static_cast<double>(y.size());
}

double variation(const VectorXd& y) {
  return mean_square(y.array() - y.mean());
}

}  // namespace

TorqueFit::TorqueFit(const ArmTree& arm, bool at_instants, bool gravity_added)
    : arm_(arm), gravity_added_(gravity_added), n_(arm.dof()), windows_(arm, at_instants) {
  for (int a = 0; a < n_; ++a)
    for (int b = a + 1; b < n_; ++b) alike_.emplace_back(a, b);
}

void TorqueFit::take(const Sample& y, bool contact, const VectorXd& tau_ext) {
  std::erase_if(alike_, [&](const auto& pair) {
    return y.tau[pair.first] != y.tau[pair.second];  // bit for bit, as no two sensors are
  });
  windows_.take(y, tau_ext.size() > 0 ? VectorXd(y.tau - tau_ext) : y.tau, contact);
}

void TorqueFit::take(const Trace& log) {
  windows_.interrupt(log.torque_at_instants);
  for (int k = 0; k < log.size(); ++k)
    take({log.t[static_cast<std::size_t>(k)], log.q.col(k), log.qd.col(k), log.tau.col(k)},
         !log.contact.empty() && log.contact[static_cast<std::size_t>(k)] != 0,
         log.has_truth() ? VectorXd(log.tau_ext.col(k)) : VectorXd());
}

// those in which a joint carries something, and hardly more than that; none where dry friction
// alone explains most of them, as the others are what the model does not know
TorqueFit::Windows TorqueFit::slow(int j) const {
  const auto leader = static_cast<std::size_t>(arm_.leaders[static_cast<std::size_t>(j)]);
  const double stiction = kStiction * arm_.joints[leader].dry;
  Windows others, held;
  for (const ArmWindow& w : windows_.windows()) {
    const double g = std::abs(w.gravity[j]);
    if (g < kMinTorqueShare * arm_.usual_torque[j] || std::abs(w.model[j] - w.gravity[j]) > 0.2 * g)
      continue;
    const bool rests =
        std::abs(w.direction[j]) < kMoving && std::abs(w.tau[j] - w.model[j]) < stiction;
    (rests ? held : others).push_back(&w);
  }
  return held.size() > others.size() ? Windows() : others;
}

// those that carry something, in slow poses
std::vector<TorqueFit::SlowJoint> TorqueFit::slow_joints() const {
  std::vector<SlowJoint> all;
  for (int j = 0; j < n_; ++j) {
    const Windows windows = slow(j);
    if (windows.size() < kMinWindows) continue;
    const VectorXd tau = each(windows, [j](const ArmWindow&w) { return w.tau[j]; }),
                   model = each(windows, [j](const ArmWindow&w) { return w.model[j]; }),
                   gravity = each(windows, [j](const ArmWindow&w) { return w.gravity[j]; });
    SlowJoint fit{.number = j + 1, .factor = factor(windows, j, tau)};
    const double s = fit.factor;
    fit.power = mean_square(model);
    fit.residual = misfit(windows, j, tau - model);
    fit.by_factor = s * s * misfit(windows, j, tau / s - model);
    fit.without_gravity = misfit(windows, j, tau - model + gravity);
    fit.without_model = misfit(windows, j, tau);
    // of a load's residual, how much a better cause may leave: nothing where the pose is one
    const double load = misfit(windows, j, tau - model, VectorXd::Ones(tau.size()));
    fit.by_load = load > kMinVariation * fit.residual ? kMaxRatio * load : 0;
    all.push_back(fit);
  }
  return all;
}

// without gravity, or in another unit, in joints that carry most of what is carried
TorqueFit::Cause TorqueFit::by_gravity(const std::vector<SlowJoint>& joints) {
  std::vector<int> without, scaled;
  std::vector<double> factors;
  std::string alone;  // of a joint that carries less than the others
  bool without_varied = false, scaled_varied = true;
  double all = 0, power_without = 0, power_scaled = 0;
  for (const SlowJoint& j : joints) {
    all += j.power;
    if (j.residual < kMinMisfit * j.power) continue;
    // what is a small part of the model has gravity in it, in another unit
    if (j.without_gravity < kMaxRatio * j.residual && j.by_factor > kMinMisfit * j.without_model) {
      without.push_back(j.number);
      power_without += j.power;
      without_varied = without_varied || j.without_gravity < j.by_load;
      if (j.without_gravity < kMaxRatioOfUnit * j.residual)
        alone = fmt::format("in slow poses tau of joint {} does not contain the torque of gravity",
                            j.number);
    } else if (j.by_factor < kMaxRatio * j.residual && (j.factor < 0.7 || j.factor > 1.4)) {
      scaled.push_back(j.number);
      factors.push_back(j.factor);
      power_scaled += j.power;
      scaled_varied = scaled_varied && j.by_factor < j.by_load;
      // more may be a load, unless all others fit, which it would act on, too
      const bool others_fit = std::all_of(joints.begin(), joints.end(), [&j](const SlowJoint& o) {
        return o.number == j.number || o.residual < kMinMisfit * o.power;
      });
      if (others_fit || (j.factor < 0.7 && j.by_factor < kMaxRatioOfUnit * j.residual))
        alone = fmt::format(
            "in slow poses tau of joint {} is {:.3g} times the torque of the model: is `unit` or "
            "`gain` of [tau] in a map (--columns) the same for each joint?",
            j.number, j.factor);
    }
  }
  if (!without.empty() && power_without > all / 2)
    return {fmt::format("in slow poses tau of {} does not contain the torque of gravity. If the "
                        "recording has it removed, use [tau_without_gravity] in a map (--columns)",
                        listed(without)),
            without_varied};
  if (scaled.empty() || !(power_scaled > all / 2)) {
    const std::string why = by_unit(joints);
    return {why.empty() ? alone : why, false};
  }
  const auto [least, most] = std::minmax_element(factors.begin(), factors.end());
  // other masses than the file's, and loads, make factors, too, but each joint its own
  const double spread =
      *least * *most > 0 ? std::max(*least / *most, *most / *least) : kMaxSpreadOfGains;
  const bool far = *most < 0.5 || *least > 5;
  if (*least > 1 && !far && !(spread < 1.2 && factors.size() > 2)) return {alone, false};  // a load
  return {fmt::format("in slow poses tau of {} is {:.3g} times the torque of the model: {}",
                      listed(scaled), fmt::join(factors, ", "),
                      *most < 0 ? "its sign is reversed: `sign = -1` of [tau] in a map (--columns)"
                      : *least > 1.8 && *most < 2.2
                          ? "is gravity added to a torque that has it already, or is this another "
                            "unit? `gain = 0.5` of [tau] in a map (--columns) halves it"
                          : "are these currents, or is this another unit? In a map "
                            "(--columns), [current] with `gain` (N m/A), or `unit`, `gain` "
                            "and `sign` of [tau], say so"),
          scaled_varied && far && spread < kMaxSpreadOfGains &&
              (factors.size() > 1 || joints.size() == 1)};
}

// a factor near 1, which other masses might make in one joint, but not in all alike
std::string TorqueFit::by_unit(const std::vector<SlowJoint>& joints) {
  std::vector<double> factors;
  double all = 0, power = 0;
  for (const SlowJoint& j : joints) {
    all += j.power;
    if (!(j.by_factor < kMaxRatioOfUnit * j.residual)) continue;
    factors.push_back(j.factor);
    power += j.power;
  }
  if (factors.empty() || !(power > all / 2)) return "";
  const auto [least, most] = std::minmax_element(factors.begin(), factors.end());
  // one joint says nothing of others, unless its factor is a unit's
  if (factors.size() < 2 && std::abs(*least / kPoundFoot - 1) > kSame - 1) return "";
  if (*most > kSame * *least || std::max(*most, 1 / *least) < kMinUnit) return "";
  return fmt::format(
      "in slow poses all torques are {:.3g} times those of the model: is this another unit (lbf "
      "ft: 0.738)? `gain = {:.4g}` of [tau] in a map (--columns) makes it N m",
      *least, 1 / *least);
}

// what a recording has without gravity has it, maybe in another unit
std::string TorqueFit::by_added_gravity() const {
  constexpr double kMostPart = 0.2;  // [1] more is a load, or masses, but what is all of it
  std::vector<int> joints;
  std::vector<double> factors;
  double all = 0, power = 0;
  for (int j = 0; j < n_; ++j) {
    const Windows windows = slow(j);
    if (windows.size() < kMinWindows) continue;
    const VectorXd measured =
                       each(windows, [j](const ArmWindow&w) { return w.tau[j] - w.gravity[j]; }),
                   model = each(windows, [j](const ArmWindow&w) { return w.model[j]; });
    const double s = factor(windows, j, measured), carried = mean_square(model);
    all += carried;
    if ((std::abs(s) > kMostPart && std::abs(s - 1) > kMostPart) ||
        misfit(windows, j, measured - s * model) > kMinMisfit * misfit(windows, j, measured))
      continue;
    joints.push_back(j + 1);
    factors.push_back(s);
    power += carried;
  }
  if (joints.empty() || !(power > all / 2)) return "";
  const bool all_of_it = std::all_of(factors.begin(), factors.end(),
                                     [](double s) { return std::abs(s - 1) <= kMostPart; });
  return fmt::format(
      "what is read as torque without gravity is, in slow poses, {:.3g} times the model's torque "
      "with it in {}: {}",
      fmt::join(factors, ", "), listed(joints),
      all_of_it ? "use [tau] in the place of [tau_without_gravity] in a map (--columns)"
                : "is gravity in it, in another unit (currents, or the motor's side of a gear)? In "
                  "a map (--columns), [current], or `unit` and `gain` of [tau], say so");
}

// half of the joints that carry something measure much less than the model, as no load makes them
std::string TorqueFit::by_another_arm(const std::vector<SlowJoint>& joints) {
  std::vector<int> light;
  std::vector<double> factors;
  for (const SlowJoint& j : joints) {
    if (!(j.residual > kMinMisfit * j.power) || j.factor > kLight) continue;
    light.push_back(j.number);
    factors.push_back(j.factor);
  }
  if (light.size() < 2 || 2 * light.size() < joints.size()) return "";
  return fmt::format(
      "in slow poses tau of {} is {:.3g} times the torque of the model: is this recording of this "
      "robot?",
      listed(light), fmt::join(factors, ", "));
}

// of a file in which nothing weighs anything
std::string TorqueFit::by_gravity_of_file() const {
  if (!arm_.gravity.isZero(0)) return "";
  ArmTree heavy = arm_;
  heavy.gravity = Vec<3>(0, 0, -kGravity);
  const WindowMaker maker(heavy, false);
  const Windows windows = thinned(windows_.windows(), kMost);
  ArmWindows with_gravity;
  for (const ArmWindow* w : windows) with_gravity.push_back(maker.window(w->motion, w->tau));
  const Windows others = thinned(with_gravity, kMost);
  double without = 0, with = 0;
  for (int j = 0; j < n_; ++j) {
    const auto rest = [j](const ArmWindow& w) { return w.tau[j] - w.model[j]; };
    without += misfit(windows, j, each(windows, rest));
    with += misfit(others, j, each(others, rest));
  }
  if (!(with < kMaxRatio * without)) return "";
  return "tau contains gravity, which the robot's file switches off: remove gravity=\"0 0 0\", or "
         "<flag gravity=\"disable\"/>, from its <option>";
}

// two channels that are one
std::string TorqueFit::by_copies() const {
  for (const auto& [a, b] : alike_) {
    const auto varies = [a = a](const ArmWindow& w) { return w.tau[a]; };
    const VectorXd tau = each(thinned(windows_.windows(), kMost), varies);
    if (tau.maxCoeff() > tau.minCoeff())
      return fmt::format(
          "tau of joints {} and {} is the same, bit for bit: name the columns in a map (--columns)",
          a + 1, b + 1);
  }
  return "";
}

// a channel that says the same all the time, though the arm moves
std::string TorqueFit::by_rest() const {
  std::vector<int> dead;
  const Windows windows = thinned(windows_.windows(), kMost);
  if (!moves(windows)) return "";
  for (int j = 0; j < n_; ++j) {
    const VectorXd tau = each(windows, [j](const ArmWindow&w) { return w.tau[j]; }),
                   model = each(windows, [j](const ArmWindow&w) { return w.model[j]; });
    const double varies = model.maxCoeff() - model.minCoeff();
    if (varies > kMinTorqueShare / 5 * arm_.usual_torque[j] &&
        tau.maxCoeff() - tau.minCoeff() < 1e-9 * varies)
      dead.push_back(j + 1);
  }
  if (dead.empty()) return "";
  return fmt::format("tau of {} never changes, though the arm moves: is it measured?",
                     listed(dead));
}

// of joints whose motion takes a torque that varies: less that, tau varies more than it does
std::string TorqueFit::by_another_motion() const {
  std::vector<int> joints;
  const Windows windows = thinned(windows_.windows(), kMost);
  const VectorXd load = VectorXd::Ones(static_cast<Eigen::Index>(windows.size()));
  for (int j = 0; j < n_; ++j) {
    const VectorXd tau = each(windows, [j](const ArmWindow&w) { return w.tau[j]; }),
                   model = each(windows, [j](const ArmWindow&w) { return w.model[j]; });
    const double least = kMinVariedShare * arm_.usual_torque[j];
    if (misfit(windows, j, model, load) < least * least) continue;
    if (misfit(windows, j, tau - model, load) < misfit(windows, j, tau, load)) return "";
    joints.push_back(j + 1);
  }
  if (joints.size() < 2) return "";
  return fmt::format(
      "tau of {} does not follow the motion: less what the motion takes, it varies more than it "
      "does by itself. Are tau and q of one recording, is it of this robot, and is tau in N m (a "
      "current is [current] in a map, --columns)?",
      listed(joints));
}

// where nothing weighs, of torques of which most are friction or a rotor that the model
// does not know, or else another unit
std::string TorqueFit::by_nothing_known() const {
  const Windows windows = thinned(windows_.windows(), kMost);
  double all = 0, left = 0, modelled = 0, carried = 0;
  for (int j = 0; j < n_; ++j) {
    const double usual = std::pow(arm_.usual_torque[j], 2);
    const VectorXd tau = each(windows, [j](const ArmWindow&w) { return w.tau[j]; }),
                   rest = each(windows, [j](const ArmWindow&w) { return w.tau[j] - w.model[j]; });
    const Eigen::ArrayXd most = VectorXd::Constant(tau.size(), kOutlier * std::sqrt(usual));
    all += variation(tau.array().min(most).max(-most)) / usual;
    const double noise =
        fit(windows, j, rest, MatrixXd::Ones(rest.size(), 1), rotor_torque(windows, j)).mean_square;
    left += std::max(variation(rest.array().min(most).max(-most)) - noise, 0.) / usual;
    modelled += mean_square(each(windows, [j](const ArmWindow& w) { return w.model[j]; })) / usual;
    carried += mean_square(each(windows, [j](const ArmWindow& w) { return w.gravity[j]; })) / usual;
  }
  if (!(left > kMostlyUnknown * all) || carried > kMinVariation * modelled) return "";
  return "nothing weighs on these joints, and the model explains little of tau: is it in N "
         "m, and not a current? Friction or rotors that the robot's file lacks may be the rest, "
         "too";
}

bool TorqueFit::is_long_enough() const {
  return windows_.windows().size() >= kMinWindows;
}

TorqueFit::Judgement TorqueFit::judge() const {
  if (!is_long_enough()) return {};
  if (std::string why = by_rest(); !why.empty()) return {why, true};
  if (std::string why = by_copies(); !why.empty()) return {why, true};
  if (std::string why = by_gravity_of_file(); !why.empty()) return {why, true};
  const auto or_else = [](const std::string& why) {
    return why + (why.ends_with('?') ? "" : ".") +
           " Or else its masses are not those of the file, it carries a load, or something touches "
           "it all the time";
  };
  if (gravity_added_)
    if (std::string why = by_added_gravity(); !why.empty()) return {or_else(why), false};
  const FoundReading reading = better_reading(arm_, windows_);
  if (reading.varied) return {reading.words, true};
  const std::vector<SlowJoint> joints = slow_joints();
  const Cause gravity = by_gravity(joints);
  if (gravity.varied) return {gravity.words, true};
  for (const std::string& why : {gravity.words, reading.words})
    if (!why.empty()) return {or_else(why), false};
  if (std::string why = found_delay(arm_, windows_); !why.empty()) return {why, false};
  if (std::string why = by_another_arm(joints); !why.empty()) return {why, false};
  if (std::string why = by_another_motion(); !why.empty()) return {why, false};
  if (std::string why = found_cause(arm_, windows_); !why.empty()) return {or_else(why), false};
  if (std::string why = by_nothing_known(); !why.empty()) return {why, false};
  double power = 0, residual = 0;
  for (const SlowJoint& j : joints) power += j.power, residual += j.residual;
  if (!(residual > power)) return {};
  return {fmt::format("in slow poses tau is {:.3g} N m away from the {:.3g} N m that hold the "
                      "robot's masses: is this recording of this robot, are the joints in this "
                      "order, and did it carry an unknown load?",
                      std::sqrt(residual), std::sqrt(power)),
          false};
}

std::string TorqueFit::contradiction() const {
  const Judgement j = judge();
  return j.sure ? j.why : "";
}

std::string TorqueFit::doubt() const {
  const Judgement j = judge();
  return j.sure ? "" : j.why;
}

bool fits(const TorqueFit& fit, const std::string& path) {
  const TorqueFit::Judgement j = fit.judge();
  if (j.sure) throw std::invalid_argument(fmt::format("{}: {}", path, j.why));
  if (!fit.is_long_enough())
    say(
        fmt::format("{}: too short to compare its torques with the robot's: {} windows of 0.1 s "
                    "without a gap or a contact are needed, so that nothing tells whether they fit",
                    path, kMinWindows));
  if (!j.why.empty()) say(fmt::format("{}: {}", path, j.why));
  return j.why.empty() && fit.is_long_enough();
}

bool torques_fit(const ArmTree& arm, const std::vector<Trace>& logs, bool gravity_added,
                 const std::vector<std::string>& paths) {
  const bool at_instants = logs.front().torque_at_instants;
  TorqueFit all(arm, at_instants, gravity_added);
  for (std::size_t i = 0; i < logs.size(); ++i) {
    all.take(logs[i]);
    if (logs.size() == 1 || logs[i].t.back() - logs[i].t.front() < kLongRecording) continue;
    TorqueFit one(arm, at_instants, gravity_added);
    one.take(logs[i]);
    if (const std::string why = one.contradiction(); !why.empty())
      throw std::invalid_argument(fmt::format("{}: {}", paths[i], why));
  }
  return fits(all, fmt::format("{}", fmt::join(paths, ", ")));
}

}  // namespace tauext
