// SPDX-License-Identifier: Apache-2.0
/// @file
/// Estimating while it happens: the body of a control loop's cycle, and its clock.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "bench/live/histogram.h"
#include "bench/roster/robot.h"
#include "lcmtypes/live_stream.h"

namespace tauext::live {

/// What one estimator did so far. Written by the loop; any thread may read it.
struct LiveFigures {
  Histogram step_ns;  ///< [ns] wall time of an update
  /// samples that made no estimate, but for the first one after a reset: bad ones, gaps,
  /// divergences
  std::atomic<std::int64_t> unusable = 0;
  StatusCounts counts;                  ///< the same by reason; to be read when the loop has ended
  std::atomic<std::int64_t> marks = 0;  ///< of its detector
  std::atomic<std::int64_t> compared = 0;                 ///< samples with a reference
  std::array<std::atomic<double>, kMaxJoints> squares{};  ///< [N^2 m^2] of the error, summed
  std::atomic<double> largest_error = 0;                  ///< [N m] of any joint
  std::atomic<double> largest_force = 0;  ///< [N] at the point where forces are looked for
  std::atomic<int> touched = 0;  ///< then, the joint, from 1, that carries the link; 0: none

  /// [N m] worst joint's root of the mean squared error; NaN without a reference.
  double rmse() const noexcept;
};

/// What training says of the detector behind an estimator.
using DetectorsOf = std::function<DetectorThresholds(const std::string& estimator)>;

/// Runs estimators, each with the same kind of detector behind it, on one sample after the other,
/// and pushes what they say into a stream. `take` neither waits, allocates nor makes a system call.
class LiveEstimation {
 public:
  /// @param trace what an estimator that copies the truth copies; else it may be empty
  /// @param thresholds_of what training says of the detector behind an estimator, by name
  /// @param stream may be null
  /// @param forces what each estimate means, for the stream; may be null, and outlives this
  /// @throws std::invalid_argument for unknown names, an estimator named twice, or more than 8
  /// joints
  LiveEstimation(const Robot& robot, const std::vector<std::string>& estimators,
                 const std::string& detector, const DetectorsOf& thresholds_of, const Trace& trace,
                 LiveStream* stream, const ArmForces* forces = nullptr);

  /// All estimators, on a reading of the robot's number of joints.
  void take(const Reading& reading) noexcept;
  /// They forget everything: the sender has started anew.
  void reset() noexcept;

  int dof() const { return dof_; }                                        ///< joints of the robot
  int size() const { return static_cast<int>(pairs_.size()); }            ///< estimators
  const std::string& name(int i) const { return pairs_[i]->name; }        ///< of estimator i
  const LiveFigures& figures(int i) const { return pairs_[i]->figures; }  ///< of estimator i
  /// That were estimated.
  std::int64_t samples() const noexcept { return samples_.load(std::memory_order_relaxed); }

 private:
  struct Watched {
    std::string name;
    Pair pair;
    LiveFigures figures{};
    bool started = false;  // since the last reset
  };
  void find_force(const Reading& r, LiveFigures& f) noexcept;
  static void compare(const Reading& r, const Joints& hat, LiveFigures& f) noexcept;

  int dof_;
  std::vector<std::unique_ptr<Watched>> pairs_;
  LiveStream* stream_;
  const ArmForces* forces_;
  LiveSample sample_;
  std::atomic<std::int64_t> samples_ = 0;
};

/// The streams of such a run, in its order.
/// @param site where forces are looked for; "": nowhere
std::vector<Stream> streams_of(const std::vector<std::string>& estimators,
                               const std::string& detector, const std::string& site = "");

/// How fast recorded samples are played.
struct Pace {
  double speed = 1;     ///< [1] simulated seconds in a second
  bool again = false;   ///< from the begin when they end
  double duration = 0;  ///< [s] of the clock, after which it ends; 0: never
};

/// Plays readings to the estimators by the clock until they end, `stop` is set or the time is over.
/// The thread that calls it is the loop: all it waits for is the time of the next sample. Where
/// they begin again, estimators are reset and time goes on.
/// @param late [ns] how much later than due a cycle began
void play(const std::vector<Reading>& readings, const Pace& pace, LiveEstimation& estimation,
          Histogram& late, const std::atomic<bool>& stop);

}  // namespace tauext::live
