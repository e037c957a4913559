// SPDX-License-Identifier: Apache-2.0
/// @file
/// What arrives from any tauext stream, as a table for a terminal.
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "lcmtypes/reading.h"
#include "lcmtypes/receive/account.h"
#include "lcmtypes/receive/senders.h"

namespace tauext::live {

/// Takes messages as they come, checks them and keeps the newest of each channel.
class StreamTable {
 public:
  /// Channels, pairs of estimator and detector, and forces, of each so many; names come from
  /// outside, and no run has a quarter of them, nor a screen room for more.
  static constexpr std::size_t kMostNames = 100;

  /// @param arrived [us] on a clock that never goes back
  /// @returns whether it is used: the one answer for all that show it
  bool take(std::string_view channel, Sender sender, std::int64_t arrived, Bytes message);

  /// A row for each joint of each channel; rates are those of the second before `now` [us, the same
  /// clock].
  std::string format(std::int64_t now) const;
  /// A row for each estimator, in at most 80 columns: of one joint.
  /// @param joint from 1; 0: of each estimator that with the largest torque
  std::string format_small(std::int64_t now, int joint) const;
  /// A row for each estimator's force; "" if there is none.
  /// @param small in at most 80 columns, without moments
  std::string format_forces(std::int64_t now, bool small) const;
  int joints() const;  ///< the largest number of any channel
  /// What became of each message of all channels, and why.
  std::string totals(const GroupSocket::Counts& refused) const;

  /// Lines that are events: marks, summaries, restarts and second senders since the last call.
  std::vector<std::string> events() { return std::exchange(events_, {}); }

  Account account() const;  ///< of all channels

 private:
  struct Channel {
    Sequence sequence;
    Senders senders;
    std::int64_t others = 0;                    // messages of a second sender
    std::deque<std::int64_t> arrivals;          // [us] of the last second
    estimate_t newest{};                        // a sample_t's fields, too
    bool estimate = false;                      // else samples alone
    std::int64_t rate(std::int64_t now) const;  // [1/s]
    force_t force{};                            // of a channel of forces
  };

  using Channels = std::map<std::string, Channel, std::less<>>;
  struct Envelope {
    std::string name;  // of the channel, or of the pair
    Sender sender;
    std::int64_t arrived;  // [us]
  };

  template <class Message>
  bool decoded(Bytes message, const Envelope& e, Message& m);
  Channel* accept(Channels& all, const Envelope& e, std::int64_t seq);
  bool use(const estimate_t& m, const Envelope& e);
  bool use(const sample_t& s, const Envelope& e);
  bool use(const detection_t& d, const Envelope& e);
  bool use(const force_t& f, const Envelope& e);
  bool use(const summary_t& s, const Envelope& e);
  void take_end(const summary_t& s, const Envelope& e);

  Channels channels_;
  Channels pairs_;   // detections, by estimator+detector
  Channels forces_;  // by estimator at site
  std::map<Reject, std::int64_t> rejects_;
  std::vector<std::string> events_;
  std::int64_t summaries_ = 0;
  std::int64_t beyond_ = 0;  // messages of names beyond kMostNames
};

}  // namespace tauext::live
