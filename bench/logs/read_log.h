// SPDX-License-Identifier: Apache-2.0
/// @file
/// A recorded log of any kind.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "bench/logs/contacts_file.h"
#include "mjcf/trace/read/recording.h"
#include "mjcf/trace/trace.h"

namespace tauext {

/// How a log is to be read.
struct LogOptions {
  /// of an LCM log the channel, of a ROS 2 bag the topic; "": the only one that holds measurements
  std::string channel;
  /// of any other log a preset or a TOML file of mjcf/trace/read/column_map.h; "": ours
  std::string columns;
  std::vector<std::string> joints;  ///< the robot's, as RecordingOptions has them
  /// whether the caller makes torques of currents, and adds gravity, by LogReader's functions or
  /// Robot::make_torques()
  bool has_robot = false;
  /// labels in the place of the log's own, if it has any; nullptr: none
  std::shared_ptr<const ContactsFile> contacts;
};

/// A recorded log: LCM, CSV, .npy, .npz or a ROS 2 bag, sample by sample.
class LogReader final : public SampleSource {
 public:
  /// @throws std::runtime_error or std::invalid_argument naming the path and the reason; next(),
  /// too, where labels do not fit (contacts_file.h)
  explicit LogReader(const std::string& path, const LogOptions& options = {});
  ~LogReader() override;

  /// Makes torques of currents, if it has these, by the gains of the drives [N m/A].
  /// @throws std::invalid_argument as require_gains does
  void use_gains(const Eigen::VectorXd& gain);
  /// Multiplies torques that are none of currents [1].
  void scale_torques(const Eigen::VectorXd& by);
  /// Adds gravity(q) [N m] to a tau without it, if that is what it has.
  void use_gravity(std::function<Eigen::VectorXd(const Eigen::VectorXd& q)> gravity);

  const RecordingContents& contents() const override;
  bool next(RecordedSample& sample) override;
  const Regularity& regularity() const override;
  /// Of the last sample, as the log has it: not scaled, not made of currents, without gravity.
  const Eigen::VectorXd& recorded_tau() const;

  std::int64_t skipped() const;          ///< rows so far, or messages of the channel, not used
  const Eigen::VectorXd& least() const;  ///< q [rad] so far, joint by joint
  const Eigen::VectorXd& most() const;   ///< likewise
  /// Says on standard error, at the end, what was skipped, what is irregular in it, and what can
  /// hardly be in the units of a Trace.
  void report() const;
  /// At the end: whether some q and qd cannot both be true: another unit, rate or sign, a qd that
  /// rests, another joint's, or of another time (15 ms or more).
  bool contradicts() const;
  /// Whether most of it could be used, q and qd agree, and each quantity is as new as the others:
  /// else it is not the log that one means.
  bool usable() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// A log, and how much of it could not be used.
struct RecordedLog {
  Trace trace;               ///< what could be used
  bool contradicts = false;  ///< as LogReader says
  /// Whether it is not usable() to LogReader, or its torques may be another robot's
  /// (bench/replay/robot_log.h).
  bool doubtful = false;
  bool usable() const { return !doubtful; }  ///< whether it is what one means
  double velocity_delay = 0;                 ///< [s] of a qd that was made of q
  /// Asked by programs that write down what they learn from it.
  /// @throws std::invalid_argument if q and qd contradict each other
  void require_consistent(const std::string& path) const;
};

/// All of a log, with its report.
/// @throws std::runtime_error or std::invalid_argument naming the path and the reason
RecordedLog read_any_log(const std::string& path, const LogOptions& options = {});

}  // namespace tauext
