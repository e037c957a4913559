// SPDX-License-Identifier: Apache-2.0
/// @file
/// Messages out of LCM's network, raw: whoever gets them decodes them by lcmtypes/wire.h.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "lcmtypes/receive/group_socket.h"
#include "lcmtypes/transport.h"

namespace tauext {

/// A subscription to channels. Multicast comes through a GroupSocket, everything else through LCM.
class Listener {
 public:
  /// Gets the channel, who sent the message, and its bytes.
  using Handler = std::function<void(std::string_view channel, Sender sender, Bytes message)>;

  /// @param channels their names; one that ends in * stands for all that begin so
  /// @throws std::runtime_error if nothing can be received from that URL, with the remedy;
  /// std::invalid_argument for a URL that LCM does not know
  Listener(const std::string& url, std::vector<std::string> channels, Handler handler);

  /// On an LCM that somebody else keeps (memq:// lives in one process).
  Listener(lcm_t* lcm, std::vector<std::string> channels, Handler handler);
  ~Listener();
  Listener(const Listener&) = delete;
  Listener& operator=(const Listener&) = delete;

  /// Waits up to so long for a message and hands on what has come; false if nothing did.
  /// @throws std::runtime_error if the connection is gone
  bool wait(int milliseconds);

  const std::string& url() const { return url_; }  ///< in full

  /// What did not get through to here; zeros where LCM receives, which does not say.
  GroupSocket::Counts refused() const;

 private:
  void subscribe();
  bool wants(std::string_view channel) const;
  bool take_from_group();
  void require_connection() const;

  std::string url_;
  std::vector<std::string> channels_;
  Handler handler_;
  std::optional<GroupSocket> group_;
  std::int64_t unwanted_ = 0;
  LcmHandle own_;
  lcm_t* lcm_ = nullptr;
  std::vector<lcm_subscription_t*> subscriptions_;
};

}  // namespace tauext
