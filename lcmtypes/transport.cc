// SPDX-License-Identifier: Apache-2.0
#include "lcmtypes/transport.h"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <cstdlib>
#include <cstring>
#include <stdexcept>

namespace tauext {
namespace {

constexpr const char* kDefault = "udpm://239.255.76.67:7667?ttl=0";
constexpr const char* kSchemes[] = {"udpm", "file", "memq", "tcpq", "mpudpm"};

std::string scheme_of(const std::string& url) {
  const auto end = url.find("://");
  std::string scheme = end == std::string::npos ? "" : url.substr(0, end);
  for (const char* known : kSchemes) {
    if (scheme == known) return scheme;
  }
  throw std::invalid_argument(fmt::format(
      "{}: an LCM URL begins with udpm://, tcpq://, memq:// or file://, like {}", url, kDefault));
}

// 239.255.76.67:7667 of a udpm URL; port 0 if it names none
sockaddr_in address_of(const std::string& url) {
  const std::string place = url.substr(7, url.find('?') - 7);  // behind udpm://
  const auto colon = place.find(':');
  sockaddr_in a{};
  a.sin_family = AF_INET;
  std::uint16_t port = 7667;
  if (colon != std::string::npos && colon + 1 < place.size()) {
    const char* const end = place.data() + place.size();
    const auto [rest, error] = std::from_chars(place.data() + colon + 1, end, port);
    if (error != std::errc() || rest != end || port == 0) {
      throw std::invalid_argument(fmt::format("{}: no port from 1 to 65535", url));
    }
  }
  a.sin_port = htons(port);
  const std::string group = place.substr(0, colon);
  if (!group.empty() && inet_pton(AF_INET, group.c_str(), &a.sin_addr) != 1) {
    throw std::invalid_argument(fmt::format("{}: '{}' is no IPv4 address", url, group));
  }
  if (group.empty()) inet_pton(AF_INET, "239.255.76.67", &a.sin_addr);
  if (!IN_MULTICAST(ntohl(a.sin_addr.s_addr))) {
    throw std::invalid_argument(fmt::format(
        "--lcm {}: {} is no multicast group (224.0.0.0 to 239.255.255.255)", url, group));
  }
  return a;
}

}  // namespace

std::string lcm_url(const std::string& url) {
  if (!url.empty()) return url;
  const char* const environment = std::getenv("LCM_DEFAULT_URL");
  return environment != nullptr && *environment != '\0' ? environment : kDefault;
}

std::string trouble_with(const std::string& url) {
  if (scheme_of(url) != "udpm") return "";
  const sockaddr_in a = address_of(url);
  const int fd = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  if (fd < 0) return fmt::format("no socket: {}", std::strerror(errno));
  // a datagram socket's connect() looks the route up
  const bool routed = ::connect(fd, reinterpret_cast<const sockaddr*>(&a), sizeof a) == 0;
  const int reason = errno;
  ::close(fd);
  if (routed) return "";
  return fmt::format(
      "no multicast route on this machine ({}). Add one: sudo ip link set lo up multicast on && "
      "sudo ip route "
      "add 224.0.0.0/4 dev lo; or write a log and open that",
      std::strerror(reason));
}

LcmHandle open_lcm(const std::string& url, std::string& why) {
  why = trouble_with(url);
  LcmHandle lcm(why.empty() ? lcm_create(url.c_str()) : nullptr, lcm_destroy);
  if (why.empty() && !lcm) why = fmt::format("LCM cannot open {}", url);
  return lcm;
}

Transport::Transport(const std::string& url) : url_(lcm_url(url)), lcm_(open_lcm(url_, trouble_)) {}

bool Transport::publish(const char* channel, Bytes message) noexcept {
  return lcm_ && lcm_publish(lcm_.get(), channel, message.data(),
                             static_cast<unsigned>(message.size())) >= 0;
}

}  // namespace tauext
