// SPDX-License-Identifier: Apache-2.0
/// @file
/// Estimators compared at one bandwidth, and over all of them: a fast estimator is noisy, a quiet one is
/// slow, and as printed none is comparable with another. On wallmobot3.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace tauext {

/// What an estimator is worth; every figure is that of its worst joint.
struct Worth {
  double bandwidth = 0;  ///< [rad/s] -3 dB, measured by `chirp`; NaN if it was not reached
  double noise = 0;  ///< [N m] standard deviation that sensors add: velocity noise of 1e-3 rad/s, q
                     ///< in steps of 4.8e-5 rad (17 bits a turn)
  double lag = 0;    ///< [s] behind `sine`
  double rise_0_90 = 0;  ///< [s] to 90 % of `step`
  double overshoot = 0;  ///< [%] of `step`
  double mass_bias =
      0;  ///< [N m] mean error in `free` if the last link is 5 % heavier than believed
  double friction_rms = 0;  ///< [N m] rms error in `free` with 5 N m of unknown dry friction
  double cpu_ns = 0;        ///< [ns] CPU time of a step, warm, best of several batches
};

/// An estimator at one bandwidth.
struct AtBandwidth {
  std::string estimator;
  double design = 0;           ///< [rad/s] for_bandwidth() of this measured the wanted one
  std::optional<Worth> worth;  ///< nothing if no design came within 25 % of it
};

/// Sets every tunable estimator so that its measured bandwidth is w [rad/s].
/// @throws std::invalid_argument unless 1 <= w <= 200
std::vector<AtBandwidth> at_equal_bandwidth(double w, int threads = 0,
                                            const std::function<void(double)>& progress = nullptr);

/// A point of an estimator's front of noise against delay.
struct ParetoPoint {
  std::string estimator;
  double design = 0;  ///< [rad/s]; 0: as the roster has it
  double noise = 0;   ///< [N m] as above
  double delay = 0;   ///< [s] to 90 % of `step`
  std::string
      dominated_by;   ///< an estimator that is as quick and at least 2 % quieter; "" if none is
  double excess = 0;  ///< [1] how much noisier this one is than that
};

/// Sweeps every tunable estimator, and adds the others as the roster has them, one point each.
std::vector<ParetoPoint> pareto(int threads = 0,
                                const std::function<void(double)>& progress = nullptr);

/// Marks who is dominated: the front of another estimator, on straight lines between its points in the
/// logarithms, lies below.
void mark_dominated(std::vector<ParetoPoint>& points);

std::string format_equal_bandwidth(double w, const std::vector<AtBandwidth>& rows);
std::string format_pareto(const std::vector<ParetoPoint>& points);

}  // namespace tauext
