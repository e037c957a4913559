// SPDX-License-Identifier: Apache-2.0
/// @file
/// A recording in windows of 0.1 s, in which its mean torque stands beside the model's.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "estimators/types.h"
#include "mjcf/plant/any_tree.h"
#include "mjcf/plant/tree.h"
#include "mjcf/trace/trace.h"

namespace tauext {

/// Means over a window, of an arm's coordinates.
struct ArmWindow {
  using VectorN = Vec<kMostCoordinates>;  ///< a number of each coordinate; 0 of those that are none
  VectorN tau = VectorN::Zero();          ///< [N m] what was measured
  VectorN model = VectorN::Zero();        ///< [N m] by (ii) of bench/calibrate/arm_motion.h
  VectorN gravity = VectorN::Zero();      ///< [N m] its share of that
  VectorN speed = VectorN::Zero();        ///< [rad/s]
  VectorN direction = VectorN::Zero();    ///< [1] of the motion, where dry friction acts
  Eigen::MatrixXd motion;                 ///< t [s], q [rad], qd [rad/s] at some samples, by column
  Eigen::MatrixXd steps;  ///< [N m s] tau's integral from each of these samples to the next
};
using ArmWindows = std::vector<ArmWindow>;  ///< in the order of their times

/// Makes them of a recording that goes by; of a long one every second eight of them are kept, or
/// every fourth, and so on.
class WindowMaker {
 public:
  /// @throws std::invalid_argument for an arm that is too large for estimators
  WindowMaker(const ArmTree& arm, bool torque_at_instants);

  /// The next sample; none in a contact.
  /// @param tau [N m] without what is known of tau_ext
  void take(const Sample& y, const Eigen::VectorXd& tau, bool contact);
  /// The next one is of another recording, whose torques are read at instants, or held.
  void interrupt(bool torque_at_instants);

  const ArmWindows& windows() const { return windows_; }  ///< those so far
  /// One whose motion it is.
  ArmWindow window(Eigen::MatrixXd motion, const ArmWindow::VectorN& tau) const;

 private:
  void begin(const Sample& y);
  void keep(const Sample& y);
  void close();

  TiedTree model_;
  bool at_instants_, begun_ = false;
  int n_;                                            // joints
  double t_ = 0;                                     // [s] of the last sample
  Eigen::VectorXd torque_;                           // and its tau
  Eigen::VectorXd integral_;                         // of tau, since the window's begin
  std::vector<Eigen::VectorXd> motion_, integrals_;  // in it
  ArmWindows windows_;
  std::size_t every_ = 1, count_ = 0;
};

/// Whether a joint moves in one of them, more than an encoder flickers by.
bool moves(const std::vector<const ArmWindow*>& windows);

/// At most that many of the windows, from all of the recording.
std::vector<const ArmWindow*> thinned(const ArmWindows& windows, std::size_t most);

/// What explains a number y [N m] of each window: `any` multiple of some columns, multiples of
/// others that are not below 0, and what friction a joint may have.
struct WindowFit {
  Eigen::VectorXd multiples;  ///< of the columns of `any`, then of `positive`
  Eigen::VectorXd residual;   ///< [N m] what is left of y
  double mean_square = 0;     ///< [(N m)^2] of it, without the fifth of the windows that is largest
};

/// The least squares. The fifth of the windows that fits worst (outliers, and touches that nobody
/// labelled) does not count.
WindowFit fit(const std::vector<const ArmWindow*>& windows, int joint, const Eigen::VectorXd& y,
              const Eigen::MatrixXd& any = {}, const Eigen::MatrixXd& positive = {});

/// Its mean square, by friction and any multiples of `others`.
double misfit(const std::vector<const ArmWindow*>& windows, int j, const Eigen::VectorXd& y,
              const Eigen::MatrixXd& others = {});

/// [1] A cause is named if it makes the rest of a joint 1.5 times smaller (mean square: 2.25),
inline constexpr double kMinImprovement = 2.25;
/// and if its likelihood is e^12 times that of the model alone, as a hundred causes are tried.
inline constexpr double kSure = 12;
/// [1] of how a torque varies, in mean squares: less matters to nobody.
inline constexpr double kNegligible = 1e-6;
inline constexpr std::size_t kFewestWindows = 20;  ///< from which causes can be told

/// Makes a fit's mean square what it would be if a factor s below 1 of the model did not make the
/// speed's noise, which is in the model, smaller.
void undo_noise(WindowFit& fit, double s);

/// How many of these residuals count as independent, by their first autocorrelation.
double independent(const Eigen::VectorXd& residual);

/// [N m/(kg m^2)] The torque that accelerates a rotor of 1 kg m^2, in each window: its mean
/// acceleration.
Eigen::VectorXd rotor_torque(const std::vector<const ArmWindow*>& windows, int joint);

/// [1] by which y is the model's torque of joint j, with any friction.
double factor(const std::vector<const ArmWindow*>& windows, int j, const Eigen::VectorXd& y);

/// A number of each window.
template <class Of>
Eigen::VectorXd each(const std::vector<const ArmWindow*>& windows, Of&& of) {
  Eigen::VectorXd all(static_cast<Eigen::Index>(windows.size()));
  Eigen::Index i = 0;
  for (const ArmWindow* w : windows) all[i++] = of(*w);
  return all;
}

}  // namespace tauext
