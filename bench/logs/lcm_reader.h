// SPDX-License-Identifier: Apache-2.0
/// @file
/// LCM logs as recordings.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "lcmtypes/log.h"
#include "mjcf/trace/read/recording.h"
#include "mjcf/trace/trace.h"

namespace tauext {

/// What a log had beside the samples that were used.
struct LogReport {
  std::string channel;        ///< that was read
  std::int64_t rejected = 0;  ///< messages on it that were no good, or of another number of joints
  std::int64_t out_of_order = 0;  ///< late or repeated
  std::int64_t lost = 0;          ///< never recorded
  bool two_arms = false;          ///< as Arrivals says
  LogFaults faults;               ///< of the file
  /// "" if there was nothing of that, else in words.
  std::string in_words() const;
};

/// A log's measurements on one channel, in the order in which an estimator would have got them.
/// Messages of another number of joints than most have are rejected. It has a truth, or the
/// driver's estimate, if all good messages have. Times count from 0 if they are those of a wall
/// clock (more than 10^8 s).
class LcmReader final : public SampleSource {
 public:
  /// @param channel by its name, or "" for the only one that has any (of several, TAUEXT_SAMPLE)
  /// @throws std::runtime_error naming path and reason: unreadable, no such channel, several to
  /// choose from, none that is good
  LcmReader(const std::string& path, const std::string& channel);
  ~LcmReader() override;

  const RecordingContents& contents() const override;
  bool next(RecordedSample& sample) override;
  const Regularity& regularity() const override;
  LogReport report() const;  ///< of what was read so far

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace tauext
