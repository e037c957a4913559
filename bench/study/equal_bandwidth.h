// SPDX-License-Identifier: Apache-2.0
/// @file
/// Estimators compared at one bandwidth: a fast estimator is noisy, a quiet one is slow, and as
/// printed none is comparable with another.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "bench/roster/robot.h"
#include "mjcf/trace/table_writer.h"
#include "mjcf/trace/trace.h"

namespace tauext::study {

/// How noisy an estimator is, and how it answers a step; every figure is that of its worst joint.
struct NoiseAndDelay {
  double noise = 0;  ///< [N m] standard deviation that sensors add: velocity noise of 1e-3 rad/s, q
                     ///< in steps of 4.8e-5 rad (17 bits a turn)
  double rise_0_90 = 0;  ///< [s] to 90 % of `step`
  double overshoot = 0;  ///< [%] of `step`
  double settling = 0;   ///< [s] until it stays within 2 % of `step`; NaN if it never does
};

/// What an estimator is worth; every figure is that of its worst joint.
struct Worth : NoiseAndDelay {
  double bandwidth = 0;  ///< [rad/s] -3 dB, measured by `chirp`; NaN if it was not reached
  double lag = 0;        ///< [s] behind `sine`
  double mass_bias =
      0;  ///< [N m] mean error in `free` if the last link is 5 % heavier than believed
  double friction_rms = 0;  ///< [N m] rms error in `free` with 5 N m of unknown dry friction
  double cpu_ns = 0;        ///< [ns] CPU time of a step, warm, best of several batches
};

/// The runs of a robot that noise and delay are measured on.
struct StepRuns {
  /// @throws std::invalid_argument for a robot without the scenarios, naming them
  explicit StepRuns(const Robot& robot);

  const Robot& robot;       ///< that they are of
  Trace step, free, noisy;  ///< of scenarios; the last one is `free` behind noisy sensors
};

/// @param specification of an estimator
NoiseAndDelay noise_and_delay(const StepRuns& runs, const std::string& specification);

/// An estimator at one bandwidth.
struct AtBandwidth {
  std::string estimator;       ///< its specification
  double design = 0;           ///< [rad/s] its key `bandwidth` at which the wanted one was measured
  std::optional<Worth> worth;  ///< nothing if no design came within 25 % of it
};

/// Those of the asked specifications whose estimators have the key `bandwidth`, without it; of the
/// robot's all if none is asked for.
/// @throws std::invalid_argument for an unknown one, and for one with the key in it
std::vector<std::string> tunable_of(const Robot& robot, const std::vector<std::string>& asked);

/// Sets every tunable estimator of the robot, or of those that are asked for, so that its measured
/// bandwidth is w [rad/s].
/// @throws std::invalid_argument unless 1 <= w <= 200, for a robot without the scenarios, naming
/// them, and as tunable_of
std::vector<AtBandwidth> at_equal_bandwidth(const Robot& robot, double w, int threads = 0,
                                            const std::function<void(double)>& progress = nullptr,
                                            const std::vector<std::string>& asked = {});

/// As text with a head and with what the columns mean.
std::string format_equal_bandwidth(const Robot& robot, double w,
                                   const std::vector<AtBandwidth>& rows,
                                   TableFormat format = TableFormat::kText);

}  // namespace tauext::study
