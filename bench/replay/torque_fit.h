// SPDX-License-Identifier: Apache-2.0
/// @file
/// Whether what a recording calls torque is what moves the arm: torques of the link's side, in N m,
/// with gravity in them, of the joints whose columns they stand in.
///
/// The mean torque of windows (arm_windows.h) is compared with that of the arm's model, and with
/// what it would be if the recording had it otherwise: without gravity, in another unit, with
/// another sign, of another joint (column_reading.h), of another time (torque_delay.h), or with
/// what slow poses do not show (torque_causes.h); each time with the Coulomb and viscous friction
/// of each joint that explains most of the rest, as hardly a file knows it.
#pragma once

#include <Eigen/Core>
#include <string>
#include <utility>
#include <vector>

#include "bench/replay/arm_windows.h"
#include "estimators/types.h"
#include "mjcf/plant/tree.h"
#include "mjcf/trace/trace.h"

namespace tauext {

/// A recording that goes by.
class TorqueFit {
 public:
  /// @param at_instants Trace::torque_at_instants
  /// @param gravity_added whether it had torques without gravity, before
  /// @throws std::invalid_argument for an arm that is too large for estimators
  TorqueFit(const ArmTree& arm, bool at_instants, bool gravity_added);

  /// The next sample; none in a contact.
  /// @param tau_ext [N m] true, which is no part of what the masses take; empty if nobody knows
  void take(const Sample& y, bool contact, const Eigen::VectorXd& tau_ext);
  /// All of a recording, which may be one of several.
  void take(const Trace& log);

  /// Whether there are windows enough to judge by.
  bool is_long_enough() const;
  /// What is wrong with it, if anything is.
  struct Judgement {
    std::string why;    ///< with the factors that were seen, and the remedy; "": nothing
    bool sure = false;  ///< whether it contradicts the arm; else it may be of another one
  };
  /// A cause is named if it explains the measured torque ten times better (mean square) than the
  /// model does; a delay, and the causes of torque_causes.h, from 2.25 times on if that is no
  /// chance. It is sure if it explains it so much better than a constant load of each joint,
  /// too, and if other masses cannot.
  Judgement judge() const;
  std::string contradiction() const;  ///< what is surely wrong, or ""
  std::string doubt() const;          ///< what may be, or ""

 private:
  using Windows = std::vector<const ArmWindow*>;
  // of a joint that carries something, mean squares in slow poses [(N m)^2]
  struct SlowJoint {
    int number;                  // from 1
    double factor;               // [1] of the measured torque
    double power = 0;            // of the model's torque
    double residual = 0;         // that the model leaves
    double by_factor = 0;        // that the factor leaves
    double without_gravity = 0;  // that the model without gravity leaves
    double without_model = 0;    // that is measured
    double by_load = 0;          // that a cause may leave, or else it might be a load
  };
  struct Cause {
    std::string words;    // "": none
    bool varied = false;  // no constant load explains it
  };

  Windows slow(int joint) const;
  std::vector<SlowJoint> slow_joints() const;
  static Cause by_gravity(const std::vector<SlowJoint>& joints);
  static std::string by_unit(const std::vector<SlowJoint>& joints);
  static std::string by_another_arm(const std::vector<SlowJoint>& joints);
  std::string by_added_gravity() const;
  std::string by_gravity_of_file() const;
  std::string by_copies() const;
  std::string by_rest() const;
  std::string by_another_motion() const;
  std::string by_nothing_known() const;

  ArmTree arm_;
  bool gravity_added_;
  int n_;  // joints
  WindowMaker windows_;
  std::vector<std::pair<int, int>> alike_;  // joints whose tau has never differed
};

/// At the end: whether it is that arm's; says on standard error why it may not be.
/// @throws std::invalid_argument naming the path where it contradicts the arm
bool fits(const TorqueFit& fit, const std::string& path);

/// The same of recordings of one arm together, each of which may contradict it by itself, too.
bool torques_fit(const ArmTree& arm, const std::vector<Trace>& logs, bool gravity_added,
                 const std::vector<std::string>& paths);

}  // namespace tauext
