// SPDX-License-Identifier: Apache-2.0
/// @file
/// The live page of tauext-live --page: its files, and the stream's messages as they are.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <string_view>

#include "lcmtypes/wire.h"

namespace tauext::live {

/// HTTP and WebSocket on 127.0.0.1, in a thread of its own. It answers GET alone, for the files of
/// bench/report/page/ and for /stream, to who names this address as Host, and as Origin; whatever
/// a page sends closes its connection.
///
/// /stream sends binary frames, at most kFrames a second, each of one message or more: the lengths
/// of its channel (2 bytes) and of its bytes (4), little endian, the channel, and the bytes.
class PageServer {
 public:
  static constexpr int kUsualPort = 7668;                 ///< LCM's and one
  static constexpr int kFrames = 30;                      ///< [1/s]
  static constexpr std::size_t kMostWaiting = 2ul << 20;  ///< [bytes] for one page; it is closed
  static constexpr std::size_t kMostPages = 8;            ///< at once

  /// @param port 0: any that is free
  /// @param title what it shows, like wallmobot3/contact
  /// @throws std::runtime_error if nothing can listen there, with the remedy
  PageServer(int port, const std::string& title);
  /// Sends what is left, for up to 3 s.
  ~PageServer();
  PageServer(const PageServer&) = delete;
  PageServer& operator=(const PageServer&) = delete;

  const std::string& url() const;  ///< of the page
  bool is_watched() const;         ///< whether a page has ever got the stream
  /// Sends a message to all pages. From any thread; waits for none of them.
  void put(std::string_view channel, Bytes message);

 private:
  class Server;
  std::unique_ptr<Server> server_;
};

}  // namespace tauext::live
