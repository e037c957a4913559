// SPDX-License-Identifier: Apache-2.0
/// @file
/// What a recording measured, and what was true, as messages of an MCAP file.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

#include "mjcf/trace/read/bag/json_message.h"
#include "mjcf/trace/read/bag/mcap_writer.h"
#include "mjcf/trace/read/recording.h"
#include "mjcf/trace/trace.h"

namespace tauext {

/// A sample is a message on /measured with t [s], q [rad], qd [rad/s] and tau [N m]; a torque that
/// was read at t is called tau_instant, one without gravity tau_without_gravity, and drives'
/// currents current [A]. With them go the robot driver's estimate, driver [N m], and a sensor's
/// force [N], where the recording has these. What is known of the truth is on /truth: t, tau_ext
/// [N m] with the sign of (3), and contact. The preset tauext_mcap reads all of it.
class McapSamples {
 public:
  /// @param has the recording, before its torques were made of currents, scaled or added to
  /// @param first a sample of it, which tells whether there is a force
  /// @throws std::runtime_error naming the path, where a current or a torque without gravity holds
  /// until the next sample, which the file cannot say
  McapSamples(McapWriter& to, const RecordingContents& has, const RecordedSample& first,
              const std::string& path);
  /// @param tau as the recording has it
  void write(const RecordedSample& y, const Eigen::VectorXd& tau);

 private:
  void put(std::string_view name, const Eigen::VectorXd& numbers);

  McapWriter& to_;
  RecordingContents has_;
  std::string torque_;  // what it is called
  bool has_force_;
  std::size_t measured_ = 0;
  std::optional<std::size_t> truth_;
  JsonMessage message_;
};

/// A trace as such a file, which appears whole or not at all.
/// @throws std::runtime_error naming the path
void write_mcap(const Trace& trace, const std::string& path);

}  // namespace tauext
