// SPDX-License-Identifier: Apache-2.0
/// @file
/// What the sensors make of the truth. All faults default to none.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <vector>

#include "mjcf/trace/random.h"
#include "mjcf/trace/screw.h"
#include "mjcf/trace/trace.h"

namespace tauext {

/// A loadcell at the end of each screw. Its faults act on the force along the screw, and reach tau
/// through (33)-(34), pose by pose: the true force is tau / (a sin Theta) at the true q, and the
/// measured tau is the measured force times a sin Theta at the measured q. On a robot without
/// screws it is a torque sensor in each joint, and N below stands for N m. In this order:
struct Loadcell {
  double scale = 1;         ///< [1] gain error: the true force times this
  double offset = 0;        ///< [N]
  double hysteresis = 0;    ///< [1] of full scale: width of the loop (play)
  double nonlinearity = 0;  ///< [1] of full scale: largest deviation, at half scale; 0 at its ends
  double noise = 0;         ///< [N] standard deviation, white
  double step = 0;          ///< [N] the reading is rounded to whole steps
  double full_scale = 0;    ///< [N] of either sign; 0: 1000 N of a screw, 3000 N m of a joint

  bool operator==(const Loadcell&) const = default;

  /// Whether it reads the true force, of whatever full scale.
  bool ideal() const {
    Loadcell perfect;
    perfect.full_scale = full_scale;
    return *this == perfect;
  }
};

/// Torque sensors in the joints, each another one: what differs from sensor to sensor is drawn from
/// the seed. Shares are of what the joint is used to (ArmTree::usual_torque). They act after a
/// loadcell's faults, in this order:
struct TorqueFaults {
  double gain = 0;        ///< [1] largest error of the gain, either way: uniform
  double hysteresis = 0;  ///< [1] share: width of the loop (play)
  double ripple = 0;      ///< [1] share: amplitude of a sine of the motor's position
  double waves = 200;     ///< [1] of the ripple in a turn of the joint: 2 a motor turn, gear 100
  double bias = 0;        ///< [1] share: largest offset, either way: uniform
  double noise = 0;       ///< [1] share: standard deviation, white

  bool operator==(const TorqueFaults&) const = default;

  /// Whether it has no fault, whatever the number of waves.
  bool ideal() const {
    TorqueFaults perfect;
    perfect.waves = waves;
    return *this == perfect;
  }
};

/// Sensor imperfections; the noise is white, Gaussian and independent for every joint.
struct Sensors {
  double velocity_noise = 0;  ///< [rad/s] standard deviation, on qd
  double encoder_step = 0;    ///< [rad] q is rounded to whole steps
  double loadcell_noise = 0;  ///< [N m] standard deviation, on tau itself, with or without screws
  Loadcell loadcell;          ///< its faults
  TorqueFaults torque;        ///< of sensors in the joints, in shares of what these are used to
  double latency = 0;         ///< [s] how old q, qd and tau are at their time stamp
  double tau_latency = 0;     ///< [s] how much older tau is than q and qd
  double jitter = 0;          ///< [s] time stamps are wrong by up to this, uniformly; order is kept
  double dropped = 0;         ///< [1] share of the samples that never arrive
  double repeated = 0;     ///< [1] share that repeats the values before it, with a new time stamp
  std::uint64_t seed = 1;  ///< same seed, same bits; every channel has a generator of its own

  bool operator==(const Sensors&) const = default;

  /// Nothing between truth and reading, whatever the seed and the loadcells' full scale.
  bool ideal() const {
    Sensors perfect;
    perfect.seed = seed;
    perfect.loadcell.full_scale = loadcell.full_scale;
    perfect.torque.waves = torque.waves;
    return *this == perfect;
  }
};

/// The velocities' noise of one seed, for sensors of that seed that see one run: what takes most of
/// their time is done once.
std::vector<Normals> velocity_noise(int dof, std::uint64_t seed);

/// Sensors at work, sample by sample.
class SensorStream {
 public:
  /// @param usual_torque [N m] of Trace, for Sensors::torque
  /// @throws std::invalid_argument for an imperfection out of range, and for shares of torques that
  /// nobody knows
  SensorStream(const Sensors& sensors, int dof, const std::vector<Screw>& screws,
               const Eigen::VectorXd& usual_torque = {});
  /// The same of a trace, with noise that was drawn before, velocity_noise(dof, sensors.seed),
  /// which must outlive it.
  SensorStream(const Sensors& sensors, const Trace& trace, std::vector<Normals>& drawn);

  /// What they read of the next true sample, until the next one is read; null if it is lost.
  const Sample* read(const Sample& truth);

 private:
  const Sample& delayed(double by) const;
  double lever(int joint, double q) const;
  double force(int joint, double true_force);
  double torque(int joint, double true_torque, double q);
  void keep_past(const Sample& truth);
  void take_values(const Sample& truth);

  Sensors s_;
  std::vector<Screw> screws_;
  Eigen::VectorXd usual_;                           // [N m]
  std::vector<double> gain_, bias_, phase_, loop_;  // of torque sensors: [1], [N m], [rad], [N m]
  std::vector<Random> velocity_, torque_, force_, joint_;
  std::vector<Normals>* drawn_ = nullptr;  // instead of velocity_
  std::size_t samples_ = 0;                // that were read
  Random clock_, line_;
  std::vector<double> play_;  // [N] of each loadcell's hysteresis
  std::deque<Sample> past_;   // as far back as the latencies reach, the newest last
  Sample reading_, last_;     // of the last sample; the last one that was not lost
  double stamp_;              // [s] its time stamp
};

/// The trace as these sensors would have recorded it; the truth in it stays the truth, sample by
/// sample: a dropped sample is missing in both.
/// @throws std::invalid_argument as SensorStream does
Trace measure(const Trace& truth, const Sensors& sensors);
/// The same, with noise that was drawn before: velocity_noise(truth.dof(), sensors.seed).
Trace measure(const Trace& truth, const Sensors& sensors, std::vector<Normals>& drawn);

}  // namespace tauext
