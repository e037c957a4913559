// SPDX-License-Identifier: Apache-2.0
/// @file
/// What the sensors make of the truth. All faults default to none.
#pragma once

#include <cstdint>

#include "mjcf/trace.h"

namespace tauext {

/// Sensor imperfections; the noise is white, Gaussian and independent for every joint.
struct Sensors {
  double velocity_noise = 0;  ///< [rad/s] standard deviation, on qd
  double encoder_step = 0;    ///< [rad] q is rounded to whole steps
  double loadcell_noise = 0;  ///< [N m] standard deviation, on tau
  std::uint64_t seed = 1;     ///< same seed, same bits; every channel has a generator of its own

  bool ideal() const { return velocity_noise == 0 && encoder_step == 0 && loadcell_noise == 0; }
};

/// The trace as these sensors would have recorded it; the truth in it stays the truth.
/// @throws std::invalid_argument for a negative or non-finite imperfection
Trace measure(const Trace& truth, const Sensors& sensors);

}  // namespace tauext
