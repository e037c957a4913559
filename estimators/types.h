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

/// The most joints of an arm that is watched by a detector.
inline constexpr int kMostDof = 8;
/// A value for each joint of an arm of up to kMostDof, without a heap.
template <class Scalar = double>
using JointVec = Eigen::Matrix<Scalar, Eigen::Dynamic, 1, 0, kMostDof, 1>;

/// The values of a Vec or of a JointVec, where they are.
template <class Scalar = double>
class JointVecView : public Eigen::Map<const JointVec<Scalar>> {
 public:
  /// Of `joints` values, which must outlive it.
  JointVecView(const Scalar* first, int joints)
      : Eigen::Map<const JointVec<Scalar>>(first, joints) {}
  /// Of all of x, likewise.
  template <int N, int Most>
  JointVecView(const Eigen::Matrix<Scalar, N, 1, 0, Most, 1>& x)
      : Eigen::Map<const JointVec<Scalar>>(x.data(), x.size()) {}
};

/// [m/s^2] gravity; the letter g is kept for the gravity torque of (3).
inline constexpr double kGravity = 9.81;

/// One sample of the sensors of an arm with N joints; with a Pack for Scalar, of several arms.
template <int N, class Scalar = double>
struct Measurement {
  Scalar t = 0;                                 ///< [s] time stamp, increasing
  Vec<N, Scalar> q = Vec<N, Scalar>::Zero();    ///< [rad] joint positions
  Vec<N, Scalar> qd = Vec<N, Scalar>::Zero();   ///< [rad/s] joint velocities
  Vec<N, Scalar> tau = Vec<N, Scalar>::Zero();  ///< [N m] link-side actuation, over [t_k, t_k+1)
};

/// What became of a sample. With all but kOk the estimate is the previous one (0 at first, and with
/// kDiverged).
enum class Status : std::uint8_t {
  kOk,       ///< used
  kStarted,  ///< used to start: the first sample, or the first of a new clock, or after too long a
             ///< gap or fault; estimate held
  kBadMeasurement,   ///< no number, or none that a sensor says; ignored
  kSingularInertia,  ///< B(q) of the model was not positive definite; estimate held
  kDiverged,         ///< the new estimate was not finite or out of range; started anew from 0
  kBadTime,          ///< t is not the next one; ignored
  kOutOfRange,       ///< beyond the limits of the arm; ignored
  kJump,             ///< a change that the arm cannot make from one sample to the next; ignored
  kFrozen,           ///< a joint says that it moves, and its readings stand still; ignored
  kUnlikely,         ///< a filter's prediction says otherwise, beyond its gate; not corrected by it
};

inline constexpr int kStatusCount = 10;  ///< of Status

/// What tables and messages call it.
constexpr const char* name_of(Status s) noexcept {
  constexpr const char* kNames[kStatusCount] = {
      "ok",       "started",  "bad measurement", "singular inertia",
      "diverged", "bad time", "beyond a limit",  "jump",
      "frozen",   "unlikely"};
  return kNames[static_cast<int>(s)];
}

/// Whether an estimator goes on or starts with a sample of this status.
constexpr bool used(Status s) noexcept {
  return s == Status::kOk || s == Status::kStarted;
}

/// An estimate of tau_ext from the samples 0..k.
template <int N, class Scalar = double>
struct Estimate {
  Vec<N, Scalar> tau_ext = Vec<N, Scalar>::Zero();  ///< [N m] with the sign of (3); always finite
  Status status = Status::kOk;                      ///< whether tau_ext may be used
  /// The joints that the status is about, bit 0 for the first; with kOk those whose readings were
  /// put right: a torque of the sample before that was an outlier, a q that has wrapped by a turn.
  std::uint8_t joints = 0;
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
