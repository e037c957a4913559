// SPDX-License-Identifier: Apache-2.0
#include "lcmtypes/transport.h"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <stdexcept>
#include <string_view>

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

// a whole number up to the limit, and nothing behind it
bool is_number(std::string_view text, unsigned limit) {
  unsigned value = 0;
  const char* const end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, value);
  return error == std::errc() && rest == end && value <= limit;
}

// ttl decides whether data leaves this machine, and LCM takes a wrong one for some other
void check_options(const std::string& url) {
  const auto question = url.find('?');
  if (question == std::string::npos) return;
  std::string_view rest = std::string_view(url).substr(question + 1);
  while (!rest.empty()) {
    const std::string_view option = rest.substr(0, rest.find('&'));
    rest.remove_prefix(std::min(option.size() + 1, rest.size()));
    const bool good =
        (option.starts_with("ttl=") && is_number(option.substr(4), 255)) ||
        (option.starts_with("recv_buf_size=") && is_number(option.substr(14), 1u << 30));
    if (good) continue;
    throw std::invalid_argument(fmt::format(
        "{}: '{}' is no option of udpm://: ttl=0 (this machine) to 255, recv_buf_size=BYTES", url,
        option));
  }
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
  check_options(url);
  const sockaddr_in a = address_of(url);
  const int fd = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  if (fd < 0) return fmt::format("no socket: {}", std::strerror(errno));
  // a datagram socket's connect() looks the route up
  const bool routed = ::connect(fd, reinterpret_cast<const sockaddr*>(&a), sizeof a) == 0;
  const int reason = errno;
  ::close(fd);
  if (routed) return "";
  const bool far = url.find("ttl=") != std::string::npos && url.find("ttl=0") == std::string::npos;
  return fmt::format(
      "no multicast route on this machine ({}). Add one: sudo ip link set {} up multicast on && "
      "sudo "
      "ip route add 224.0.0.0/4 dev {}; or write a log, --lcm 'file://PATH?mode=w', and open that",
      std::strerror(reason), far ? "INTERFACE" : "lo", far ? "INTERFACE" : "lo");
}

LcmHandle open_lcm(const std::string& url, std::string& why) {
  why = trouble_with(url);
  LcmHandle lcm(why.empty() ? lcm_create(url.c_str()) : nullptr, lcm_destroy);
  if (why.empty() && !lcm) why = fmt::format("LCM cannot open {}", url);
  return lcm;
}

Transport::Transport(const std::string& url)
    : url_(lcm_url(url)), lcm_(nullptr, lcm_destroy), log_(nullptr, lcm_eventlog_destroy) {
  if (scheme_of(url_) != "file") {
    lcm_ = open_lcm(url_, trouble_);
    return;
  }
  const auto question = url_.find('?');
  if (question == std::string::npos || url_.substr(question) != "?mode=w") {
    throw std::invalid_argument(fmt::format("{}: to write a log add ?mode=w", url_));
  }
  const std::string path = url_.substr(7, question - 7);  // behind file://
  log_.reset(lcm_eventlog_create(path.c_str(), "w"));
  if (!log_)
    throw std::runtime_error(
        fmt::format("{}: cannot open for writing: {}", path, std::strerror(errno)));
}

bool Transport::publish(const char* channel, Bytes message) noexcept {
  if (log_) {
    lcm_eventlog_event_t event{};
    event.timestamp = std::chrono::duration_cast<std::chrono::microseconds>(
                          std::chrono::system_clock::now().time_since_epoch())
                          .count();
    event.channellen = static_cast<std::int32_t>(std::strlen(channel));
    event.datalen = static_cast<std::int32_t>(message.size());
    event.channel = const_cast<char*>(channel);
    event.data = const_cast<std::byte*>(message.data());
    return lcm_eventlog_write_event(log_.get(), &event) == 0 && std::fflush(log_->f) == 0;
  }
  return lcm_ && lcm_publish(lcm_.get(), channel, message.data(),
                             static_cast<unsigned>(message.size())) >= 0;
}

}  // namespace tauext
