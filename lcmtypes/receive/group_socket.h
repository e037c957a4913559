// SPDX-License-Identifier: Apache-2.0
/// @file
/// LCM's multicast, received by a socket of our own. LCM's receiver binds to every address of the
/// machine, and two small datagrams from anybody end its process; here nobody is believed.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include "lcmtypes/lcm_url.h"
#include "lcmtypes/receive/senders.h"
#include "lcmtypes/wire.h"

namespace tauext {

/// A message in LCM's short form.
struct Datagram {
  std::string_view channel;  ///< 1 to 63 bytes, none of them 0
  Bytes message;             ///< as it was published
};

/// Why a datagram was refused.
enum class Refusal : std::uint8_t {
  kNone,       ///< it was not
  kFragment,   ///< a part of a message beyond 64 kB (LC03): none of our types is that long
  kMalformed,  ///< not LCM's short form (LC02), or no channel
  kOutside,    ///< from another machine, and the URL says ttl=0
};

/// Takes a datagram apart; the parts point into it. `out` is untouched unless kNone comes back.
Refusal parse(Bytes datagram, Datagram& out) noexcept;

/// Receives what is sent to a group, and to nothing but that group.
class GroupSocket {
 public:
  /// What was not handed on.
  struct Counts {
    std::int64_t fragments = 0, malformed = 0, outside = 0;  ///< datagrams, by their Refusal
    std::int64_t unwanted = 0;  ///< good ones on channels that nobody asked for
    std::int64_t dropped = 0;   ///< datagrams that came faster than they were taken: by the kernel
  };

  /// With ttl=0 the group is joined where this machine's own senders send, and who sends from an
  /// address that is not this machine's is refused; the kernel lets nobody outside use one of ours.
  /// @throws std::runtime_error if nothing can be received there
  explicit GroupSocket(const GroupUrl& url);
  ~GroupSocket();
  GroupSocket(const GroupSocket&) = delete;
  GroupSocket& operator=(const GroupSocket&) = delete;

  int descriptor() const { return socket_; }  ///< readable when a datagram is there

  /// The next datagram that is there; what it says is good until the next call. False: none.
  /// Where it is refused, `out.channel` is empty.
  bool take(Datagram& out, Sender& sender);

  Counts counts() const;  ///< since the begin

 private:
  Refusal judge(Bytes datagram, std::uint32_t address, Datagram& out);
  bool is_ours(std::uint32_t address);
  void read_addresses();

  int socket_;
  bool everybody_;
  bool zero_is_ours_;  // a sender has no address where the route leads to lo, and lo alone has one
  std::vector<std::byte> buffer_;
  std::vector<std::uint32_t> ours_;        // IPv4 addresses of this machine, in network order
  std::int64_t addresses_read_ = 0;        // [us] when
  std::array<std::int64_t, 4> refused_{};  // by Refusal
};

}  // namespace tauext
