// SPDX-License-Identifier: Apache-2.0
/// @file
/// What the sensors make of the truth. All faults default to none.
#pragma once

#include <cstdint>
#include <vector>

#include "mjcf/random.h"
#include "mjcf/trace.h"

namespace tauext {

/// A loadcell at the end of each screw. Its faults act on the force along the screw, and reach tau
/// through (33)-(34), pose by pose: the true force is tau / (a sin Theta) at the true q, and the
/// measured tau is the measured force times a sin Theta at the measured q. In this order:
struct Loadcell {
  double scale = 1;          ///< [1] gain error: the true force times this
  double offset = 0;         ///< [N]
  double hysteresis = 0;     ///< [1] of full scale: width of the loop (play)
  double nonlinearity = 0;   ///< [1] of full scale: largest deviation, at half scale; 0 at its ends
  double noise = 0;          ///< [N] standard deviation, white
  double step = 0;           ///< [N] the reading is rounded to whole steps
  double full_scale = 1000;  ///< [N] of either sign

  bool ideal() const {
    return scale == 1 && offset == 0 && hysteresis == 0 && nonlinearity == 0 && noise == 0 &&
           step == 0;
  }
};

/// Sensor imperfections; the noise is white, Gaussian and independent for every joint.
struct Sensors {
  double velocity_noise = 0;  ///< [rad/s] standard deviation, on qd
  double encoder_step = 0;    ///< [rad] q is rounded to whole steps
  double loadcell_noise =
      0;                   ///< [N m] standard deviation, on tau itself, for a robot without screws
  Loadcell loadcell;       ///< for a robot with screws
  std::uint64_t seed = 1;  ///< same seed, same bits; every channel has a generator of its own

  bool ideal() const {
    return velocity_noise == 0 && encoder_step == 0 && loadcell_noise == 0 && loadcell.ideal();
  }
};

/// Sensors at work, sample by sample.
class SensorStream {
 public:
  /// @throws std::invalid_argument for an imperfection out of range, or a loadcell without screws
  SensorStream(const Sensors& sensors, int dof, const std::vector<Screw>& screws);

  /// What they read of the true q, qd and tau of the next sample.
  Sample read(Sample truth);

 private:
  double force(int joint, double true_force);

  Sensors s_;
  std::vector<Screw> screws_;
  std::vector<Random> velocity_, torque_, force_;
  std::vector<double> play_;  // [N] of each loadcell's hysteresis
};

/// The trace as these sensors would have recorded it; the truth in it stays the truth.
/// @throws std::invalid_argument as SensorStream does
Trace measure(const Trace& truth, const Sensors& sensors);

}  // namespace tauext
