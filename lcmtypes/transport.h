// SPDX-License-Identifier: Apache-2.0
/// @file
/// Messages into LCM's network. Nothing here is made unless somebody asked for a URL.
#pragma once

#include <lcm/eventlog.h>
#include <lcm/lcm.h>

#include <cstdint>
#include <memory>
#include <string>

#include "lcmtypes/lcm_url.h"
#include "lcmtypes/wire.h"

namespace tauext {

/// Why nothing could be sent to or received from the URL: no multicast route, with the commands
/// that add one. "" if there is no reason to think so. Opens a socket and sends nothing.
/// @throws std::invalid_argument for a URL that LCM does not know
std::string trouble_with(const std::string& url);

/// LCM, with who destroys it.
using LcmHandle = std::unique_ptr<lcm_t, decltype(&lcm_destroy)>;

/// A log, with who closes it.
using LogHandle = std::unique_ptr<lcm_eventlog_t, decltype(&lcm_eventlog_destroy)>;

/// LCM on that URL; null, and why, if that cannot be.
/// @throws std::invalid_argument for a URL that LCM does not know
LcmHandle open_lcm(const std::string& url, std::string& why);

/// Publishes messages that are already encoded. Safe from one thread. A log, file://PATH?mode=w, is
/// written here and not by LCM, which would not notice a full disk; it follows no link.
class Transport {
 public:
  /// Never throws for a network that is not there: see good().
  /// @throws std::invalid_argument for a URL that LCM does not know; std::runtime_error for a log
  /// that cannot be made
  explicit Transport(const std::string& url);

  const std::string& url() const { return url_; }  ///< in full
  bool good() const {
    return lcm_ != nullptr || log_ != nullptr;
  }  ///< whether anything can be sent
  /// Why it is not good, in one line, and what to do.
  const std::string& trouble() const { return trouble_; }

  /// False if it could not be sent. A slow subscriber never makes it wait, except on tcpq://.
  bool publish(const char* channel, Bytes message) noexcept;

  lcm_t* handle() const { return lcm_.get(); }  ///< null for a log

 private:
  std::string url_, trouble_;
  LcmHandle lcm_;
  LogHandle log_;
};

}  // namespace tauext
