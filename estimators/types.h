// SPDX-License-Identifier: Apache-2.0
/// @file
/// The plain data that flows through tauext: what is measured, what is estimated, what is marked.
///
/// Sign of tau_ext, everywhere: equation (3) of the paper,
///     B(q) qdd + C(q, qd) qd + F(qd) + g(q) + tau_ext = tau,
/// so tau_ext = -J(q)^T f with f the force that the outside applies TO the robot.
///
/// Sampling: sample k holds t_k, q_k, qd_k and tau_k, the torque held over [t_k, t_k+1).
/// The truth of sample k is the tau_ext that acts over the same interval.
#pragma once

#include <Eigen/Core>
#include <cstdint>

namespace tauext {

/// A value for each of N joints.
template <int N, class Scalar = double>
using Vec = Eigen::Matrix<Scalar, N, 1>;
/// A matrix over N joints.
template <int N, class Scalar = double>
using Mat = Eigen::Matrix<Scalar, N, N>;

/// [m/s^2] gravity; the letter g is kept for the gravity torque of (3).
inline constexpr double kGravity = 9.81;

/// One sample of the sensors of an arm with N joints.
template <int N>
struct Measurement {
  double t = 0;                 ///< [s] time stamp, increasing
  Vec<N> q = Vec<N>::Zero();    ///< [rad] joint positions
  Vec<N> qd = Vec<N>::Zero();   ///< [rad/s] joint velocities
  Vec<N> tau = Vec<N>::Zero();  ///< [N m] link-side actuation, held over [t_k, t_k+1)
};

/// What became of a sample. With all but kOk the estimate is the previous one (0 at first).
enum class Status : std::uint8_t {
  kOk,       ///< used
  kStarted,  ///< used to start: the first sample, or the first after too long a gap; estimate held
  kBadMeasurement,   ///< not finite, out of range, or not later than the last one; ignored
  kSingularInertia,  ///< B(q) of the model was not positive definite; estimate held
  kDiverged,         ///< the new estimate was not finite or out of range; started anew from 0
};

/// An estimate of tau_ext from the samples 0..k.
template <int N>
struct Estimate {
  Vec<N> tau_ext = Vec<N>::Zero();  ///< [N m] with the sign of (3); always finite
  Status status = Status::kOk;      ///< whether tau_ext may be used
};

/// What a detector takes a contact for.
enum class Contact : std::uint8_t {
  kNone,         ///< nobody touches the arm
  kIntentional,  ///< a human guides or pushes it
  kCollision,    ///< a blow: forces that rise within tens of milliseconds
  kClamping,     ///< something is caught: a force that rises slowly and beyond any push
};

/// A detector's answer to one estimate.
struct Detection {
  bool mark = false;  ///< the fiducial mark: true on the one sample where the robot should react
  double score = 0;   ///< [1] decision quantity over its threshold: marks begin at 1
  /// With a mark, what for. A classifier says it at every sample, others kNone without a mark.
  Contact contact = Contact::kNone;
};

}  // namespace tauext
