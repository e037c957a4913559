// SPDX-License-Identifier: Apache-2.0
#include "lcmtypes/receive/group_socket.h"

#include <fmt/format.h>
#include <ifaddrs.h>
#include <linux/sock_diag.h>
#include <net/if.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <memory>
#include <stdexcept>

namespace tauext {
namespace {

constexpr std::size_t kLargest = 65536;  // [bytes] of a datagram
// 224.0.0.0/24, to which the kernel lets others send without an address of their own
constexpr std::uint32_t kLocalControl = 0xe00000;

std::int64_t now_us() {
  return std::chrono::duration_cast<std::chrono::microseconds>(
             std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

template <class Value>
bool set(int socket, int level, int option, const Value& value) {
  return ::setsockopt(socket, level, option, &value, sizeof value) == 0;
}

bool join(int socket, in_addr group, int interface) {
  ip_mreqn request{};
  request.imr_multiaddr = group;
  request.imr_ifindex = interface;  // 0: where the route leads
  return set(socket, IPPROTO_IP, IP_ADD_MEMBERSHIP, request);
}

[[noreturn]] void fail(int socket, const char* what) {
  const int reason = errno;
  ::close(socket);
  throw std::runtime_error(fmt::format("{}: {}", what, std::strerror(reason)));
}

}  // namespace

Refusal parse(Bytes datagram, Datagram& out) noexcept {
  constexpr std::size_t kHead = 8;  // LC02 or LC03, and a number of which we make no use
  if (datagram.size() < kHead) return Refusal::kMalformed;
  const std::string_view text(reinterpret_cast<const char*>(datagram.data()), datagram.size());
  if (text.starts_with("LC03")) return Refusal::kFragment;
  if (!text.starts_with("LC02")) return Refusal::kMalformed;
  const std::size_t size = text.substr(kHead, kLongestChannel + 1).find('\0');
  if (size == 0 || size == text.npos) return Refusal::kMalformed;
  out.channel = text.substr(kHead, size);
  out.message = datagram.subspan(kHead + size + 1);
  return Refusal::kNone;
}

GroupSocket::GroupSocket(const GroupUrl& url)
    : socket_(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0)),
      everybody_(url.ttl > 0),
      zero_is_ours_(ntohl(url.place.sin_addr.s_addr) >> 8 != kLocalControl),
      buffer_(kLargest) {
  if (socket_ < 0) fail(socket_, "no socket");
  if (!set(socket_, SOL_SOCKET, SO_REUSEADDR, 1) ||      // others listen, too
      !set(socket_, IPPROTO_IP, IP_MULTICAST_ALL, 0)) {  // not to groups that others have joined
    fail(socket_, "no socket for multicast");
  }
  if (!set(socket_, SOL_SOCKET, SO_RCVBUFFORCE, url.receive_buffer)) {
    set(socket_, SOL_SOCKET, SO_RCVBUF, url.receive_buffer);  // as much as a user may
  }
  const auto* const place = reinterpret_cast<const sockaddr*>(&url.place);
  if (::bind(socket_, place, sizeof url.place) != 0) fail(socket_, "cannot bind to the group");
  if (!join(socket_, url.place.sin_addr, 0)) fail(socket_, "cannot join the group");
  // and by way of lo, where some senders have been told to send
  join(socket_, url.place.sin_addr, static_cast<int>(::if_nametoindex("lo")));
  read_addresses();
}

GroupSocket::~GroupSocket() {
  ::close(socket_);
}

bool GroupSocket::take(Datagram& out, Sender& sender) {
  sockaddr_in from{};
  socklen_t length = sizeof from;
  const ssize_t size = ::recvfrom(socket_, buffer_.data(), buffer_.size(), 0,
                                  reinterpret_cast<sockaddr*>(&from), &length);
  if (size < 0) return false;
  out = {};
  const Bytes datagram = Bytes(buffer_).first(static_cast<std::size_t>(size));
  ++refused_[static_cast<std::size_t>(judge(datagram, from.sin_addr.s_addr, out))];
  sender = std::uint64_t{ntohl(from.sin_addr.s_addr)} << 16 | ntohs(from.sin_port);
  return true;
}

Refusal GroupSocket::judge(Bytes datagram, std::uint32_t address, Datagram& out) {
  return everybody_ || is_ours(address) ? parse(datagram, out) : Refusal::kOutside;
}

bool GroupSocket::is_ours(std::uint32_t address) {
  if (address == INADDR_ANY) return zero_is_ours_;
  constexpr std::int64_t kEvery = 1'000'000;  // [us] interfaces get and lose addresses
  if (now_us() - addresses_read_ > kEvery) read_addresses();
  return std::find(ours_.begin(), ours_.end(), address) != ours_.end();
}

void GroupSocket::read_addresses() {
  addresses_read_ = now_us();
  ifaddrs* first = nullptr;
  if (::getifaddrs(&first) != 0) return;
  const std::unique_ptr<ifaddrs, decltype(&::freeifaddrs)> all(first, ::freeifaddrs);
  ours_.clear();
  for (const ifaddrs* i = first; i != nullptr; i = i->ifa_next) {
    if (i->ifa_addr == nullptr || i->ifa_addr->sa_family != AF_INET) continue;
    ours_.push_back(reinterpret_cast<const sockaddr_in*>(i->ifa_addr)->sin_addr.s_addr);
  }
}

GroupSocket::Counts GroupSocket::counts() const {
  const auto of = [&](Refusal r) { return refused_[static_cast<std::size_t>(r)]; };
  Counts c{of(Refusal::kFragment), of(Refusal::kMalformed), of(Refusal::kOutside)};
  // SO_RXQ_OVFL's counter, without waiting for the next datagram to bring it
  std::array<std::uint32_t, SK_MEMINFO_VARS> memory{};
  socklen_t size = sizeof memory;
  if (::getsockopt(socket_, SOL_SOCKET, SO_MEMINFO, memory.data(), &size) == 0) {
    c.dropped = memory[SK_MEMINFO_DROPS];
  }
  return c;
}

}  // namespace tauext
