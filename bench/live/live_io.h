// SPDX-License-Identifier: Apache-2.0
/// @file
/// What tauext-live is connected to: where its messages go, and where measurements come from.
#pragma once

#include <fmt/format.h>

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "bench/live/live_report.h"
#include "bench/live/options.h"
#include "bench/live/view/viewers.h"
#include "lcmtypes/listener.h"
#include "lcmtypes/receive/arrivals.h"

namespace tauext::live {

/// A stream, if one was asked for, by LCM or to who looks on, and what is to be said of it.
class Outlet {
 public:
  /// @param rate [1/s] of sample time
  /// @throws std::invalid_argument for a URL or a rate that cannot be
  Outlet(const Options& options, const std::string& title, double rate);

  LiveStream* stream() { return stream_ ? &*stream_ : nullptr; }
  /// Where it goes, in words.
  std::string where() const {
    return (transport_ ? " to " + transport_->url() : "") + viewers_->where();
  }

  /// Once: messages do not go out any more.
  void report_failures();
  /// Sends what is left, and the summaries.
  StreamReport finish(std::vector<summary_t> summaries);

 private:
  void publish(std::vector<summary_t>& summaries, std::int64_t dropped);

  std::vector<Stream> streams_;
  std::shared_ptr<Viewers> viewers_;
  std::shared_ptr<Transport> transport_;  // null without LCM
  std::optional<LiveStream> stream_;
  bool reported_ = false;
};

/// Measurements that arrive, to the estimators.
class Inlet {
 public:
  /// All but the options must outlive it.
  /// @throws std::runtime_error if nothing can be received
  Inlet(const Options& options, const Robot& robot, LiveEstimation& estimation, LiveReport& report);

  const std::string& url() const { return listener_.url(); }
  /// Takes what has come, waiting up to 50 ms; false once the connection is gone.
  bool wait();

 private:
  void take(Sender sender, Bytes message);
  void take_summary(Sender sender, Bytes message);
  void explain(Reject reject, int joints) const;

  std::string channel_;
  MessageType type_;
  const Robot& robot_;
  LiveEstimation& estimation_;
  LiveReport& report_;
  Arrivals arrivals_;
  bool explained_ = false;  // the first message that was rejected
  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
  Listener listener_;
};

}  // namespace tauext::live
