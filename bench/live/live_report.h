// SPDX-License-Identifier: Apache-2.0
/// @file
/// What tauext-live says: a line while it runs, a summary at its end.
#pragma once

#include <chrono>
#include <string>
#include <vector>

#include "bench/live/live.h"
#include "bench/program/program.h"
#include "lcmtypes/receive/arrivals.h"

namespace tauext::live {

/// How a stream fared.
struct StreamReport {
  bool asked = false;  ///< whether there was to be one
  bool hung = false;   ///< it did not end; what follows may be too small
  std::string url;
  LiveStream::Counts counts;
};

/// A run, once it is over.
struct LiveReport {
  std::string title;                ///< robot and source
  double seconds = 0;               ///< [s] by the clock
  bool subscribed = false;          ///< else it was played
  bool failed = false;              ///< the connection broke
  const Histogram* late = nullptr;  ///< of the cycles, if it was played
  double period = 1e6;              ///< [ns] of them
  Arrivals::Counts arrivals;        ///< if it was subscribed
  GroupSocket::Counts refused;      ///< datagrams that did not get as far as that
  StreamReport stream;
};

/// The report as a text of some lines.
std::string format(const LiveReport& report, const LiveEstimation& estimation);

/// A summary_t for each estimator, without what the stream counts.
std::vector<summary_t> summaries_of(const LiveReport& report, const LiveEstimation& estimation,
                                    const std::string& detector);

/// The line of a running program on a terminal's standard error, twice a second; nothing elsewhere.
class StatusLine {
 public:
  void show(const LiveEstimation& estimation, const Histogram* late, const LiveStream* stream);
  void clear() { line_.clear(); }

 private:
  Progress line_{""};
  std::chrono::steady_clock::time_point shown_, begin_ = std::chrono::steady_clock::now();
};

}  // namespace tauext::live
