// SPDX-License-Identifier: Apache-2.0
/// @file
/// What arrives from any tauext stream, as a table for a terminal.
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "lcmtypes/reading.h"
#include "lcmtypes/sequence.h"

namespace tauext::live {

/// Takes messages as they come, checks them and keeps the newest of each channel.
class StreamTable {
 public:
  /// @param arrived [us] on a clock that never goes back
  void take(std::string_view channel, std::int64_t arrived, Bytes message);

  /// A row for each joint of each channel; rates are those of the second before `now` [us, the same
  /// clock].
  std::string format(std::int64_t now) const;
  /// "good, lost, rejected" of all channels, and why.
  std::string totals() const;

  /// Lines that are events: marks and summaries that came since the last call.
  std::vector<std::string> events();

  std::int64_t good() const { return good_; }
  std::int64_t lost() const;
  std::int64_t strays() const;  ///< copies, or another sender's on the same channel
  std::int64_t rejected() const;

 private:
  struct Channel {
    Sequence sequence;
    std::deque<std::int64_t> arrivals;  // [us] of the last second
    estimate_t newest{};                // a sample_t's fields, too
    bool estimate = false;              // else samples alone
  };

  template <class Count>
  std::int64_t sum(Count&& count) const;
  template <class Message>
  bool decoded(Bytes message, Message& m);
  Channel& of(std::map<std::string, Channel, std::less<>>& all, const std::string& name);
  static void count(Channel& c, std::int64_t seq, std::int64_t arrived);
  void take_detection(const detection_t& d, std::int64_t arrived);
  void take_summary(const summary_t& s);

  std::map<std::string, Channel, std::less<>> channels_;
  std::map<std::string, Channel, std::less<>> pairs_;  // detections, by estimator and detector
  Channel others_;                                     // of more channels than a table can hold
  std::map<Reject, std::int64_t> rejects_;
  std::vector<std::string> events_;
  std::int64_t good_ = 0;
};

}  // namespace tauext::live
