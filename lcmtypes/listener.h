// SPDX-License-Identifier: Apache-2.0
/// @file
/// Messages out of LCM's network, raw: whoever gets them decodes them by lcmtypes/wire.h.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>

#include "lcmtypes/transport.h"

namespace tauext {

/// A subscription to the channels that a regular expression names.
class Listener {
 public:
  /// Gets the channel, when the message arrived [us, this machine's wall clock], and its bytes.
  using Handler =
      std::function<void(std::string_view channel, std::int64_t arrived, Bytes message)>;

  /// @throws std::runtime_error if nothing can be received from that URL, with the remedy;
  /// std::invalid_argument for a URL that LCM does not know
  Listener(const std::string& url, const std::string& channels, Handler handler);

  /// On an LCM that somebody else keeps (memq:// lives in one process).
  Listener(lcm_t* lcm, const std::string& channels, Handler handler);
  ~Listener();
  Listener(const Listener&) = delete;
  Listener& operator=(const Listener&) = delete;

  /// Waits up to so long for a message and hands on what has come; false if nothing did.
  /// @throws std::runtime_error if the connection is gone
  bool wait(int milliseconds);

  const std::string& url() const { return url_; }  ///< in full

  /// The regular expression that means this channel alone.
  static std::string expression(const std::string& channel);

 private:
  void subscribe(const std::string& channels);
  void require_connection() const;

  std::string url_;
  LcmHandle own_;
  lcm_t* lcm_;
  lcm_subscription_t* subscription_ = nullptr;
  Handler handler_;
};

}  // namespace tauext
