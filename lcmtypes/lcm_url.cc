// SPDX-License-Identifier: Apache-2.0
#include "lcmtypes/lcm_url.h"

#include <arpa/inet.h>
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <cstdlib>
#include <stdexcept>
#include <string_view>

namespace tauext {
namespace {

constexpr const char* kDefault = "udpm://239.255.76.67:7667?ttl=0";
constexpr const char* kSchemes[] = {"udpm", "file", "memq", "tcpq"};

// a whole number in these limits, and nothing behind it
template <class Number>
bool number(std::string_view text, Number least, Number most, Number& out) {
  const char* const end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, out);
  return error == std::errc() && rest == end && out >= least && out <= most;
}

void read_option(const std::string& url, std::string_view option, GroupUrl& out) {
  constexpr std::string_view kTtl = "ttl=", kBuffer = "recv_buf_size=";
  const bool good =
      (option.starts_with(kTtl) && number(option.substr(kTtl.size()), 0, 255, out.ttl)) ||
      (option.starts_with(kBuffer) &&
       number(option.substr(kBuffer.size()), 1, 1 << 30, out.receive_buffer));
  if (good) return;
  throw std::invalid_argument(fmt::format(
      "{}: '{}' is no option of udpm://: ttl=0 (this machine) to 255, recv_buf_size=BYTES", url,
      option));
}

sockaddr_in read_place(const std::string& url, const std::string& place) {
  const std::size_t colon = place.find(':');
  std::uint16_t port = 7667;
  if (colon != std::string::npos && colon + 1 < place.size() &&
      !number<std::uint16_t>(std::string_view(place).substr(colon + 1), 1, 65535, port)) {
    throw std::invalid_argument(fmt::format("{}: no port from 1 to 65535", url));
  }
  std::string group = place.substr(0, colon);
  if (group.empty()) group = "239.255.76.67";
  sockaddr_in out{};
  out.sin_family = AF_INET;
  out.sin_port = htons(port);
  if (inet_pton(AF_INET, group.c_str(), &out.sin_addr) != 1) {
    throw std::invalid_argument(fmt::format("{}: '{}' is no IPv4 address", url, group));
  }
  if (!IN_MULTICAST(ntohl(out.sin_addr.s_addr))) {
    throw std::invalid_argument(
        fmt::format("{}: {} is no multicast group (224.0.0.0 to 239.255.255.255)", url, group));
  }
  return out;
}

}  // namespace

std::string lcm_url(const std::string& url) {
  if (!url.empty()) return url;
  const char* const environment = std::getenv("LCM_DEFAULT_URL");
  return environment != nullptr && *environment != '\0' ? environment : kDefault;
}

std::string scheme_of(const std::string& url) {
  const std::size_t end = url.find("://");
  std::string scheme = end == std::string::npos ? "" : url.substr(0, end);
  for (const char* known : kSchemes) {
    if (scheme == known) return scheme;
  }
  throw std::invalid_argument(fmt::format(
      "{}: an LCM URL begins with udpm://, tcpq://, memq:// or file://, like {}", url, kDefault));
}

std::string log_of(const std::string& url) {
  constexpr std::string_view kScheme = "file://";
  if (!url.starts_with(kScheme)) return "";
  return url.substr(kScheme.size(), url.find('?') - kScheme.size());
}

GroupUrl group_url(const std::string& url) {
  if (scheme_of(url) != "udpm") throw std::invalid_argument(url + ": not udpm://");
  const std::size_t question = url.find('?');
  GroupUrl out;
  out.place = read_place(url, url.substr(7, question - 7));  // behind udpm://
  if (question == std::string::npos) return out;
  std::string_view rest = std::string_view(url).substr(question + 1);
  while (!rest.empty()) {
    const std::string_view option = rest.substr(0, rest.find('&'));
    rest.remove_prefix(std::min(option.size() + 1, rest.size()));
    read_option(url, option, out);
  }
  return out;
}

}  // namespace tauext
