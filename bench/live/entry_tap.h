// SPDX-License-Identifier: Apache-2.0
/// @file
/// The suite's entries, tapped: to a stream as each finishes, to a log as each is scored.
/// Never inside a timed loop.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "bench/score/suite.h"
#include "lcmtypes/log.h"
#include "lcmtypes/wire.h"

namespace tauext {

/// The samples of an entry, its estimates and detections, one message each, and its summary: all
/// that is to be seen of it in lcm-spy. Time is simulated, and nothing else is in it that differs
/// from run to run.
void append_entry(const Entry& entry, const Trace& trace, const Output& output,
                  const std::vector<Detection>& detections, const Score& score, LogBuffer& log);

/// A summary_t of an entry's score, without counts.
summary_t summary_of(const Entry& entry, const Score& score);

/// Where finished entries go.
class EntryTap {
 public:
  /// @param url where summaries go; none: nowhere
  /// @param folder where logs go, one for each entry; "": nowhere
  /// @throws std::invalid_argument for a URL that LCM does not know; std::runtime_error for a
  /// folder that cannot be made
  EntryTap(const std::optional<std::string>& url, std::string folder);
  ~EntryTap();

  /// Writes ROBOT_SCENARIO_ESTIMATOR[+DETECTOR].lcm: samples, estimates, detections,
  /// summary.
  /// @throws std::runtime_error naming the file
  void log(const Entry& entry, const Suite::Run& run, const Score& score) const;
  bool logs() const { return !folder_.empty(); }  ///< whether it writes any

  /// Publishes the entry's summary_t. A network that is not there is told once, and the run goes
  /// on.
  void publish(const Entry& entry, const Score& score);
  /// False if summaries should have gone out and none did.
  bool heard() const;

 private:
  struct Outlet;
  std::unique_ptr<Outlet> outlet_;
  std::string folder_;
};

}  // namespace tauext
