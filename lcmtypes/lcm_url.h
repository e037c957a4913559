// SPDX-License-Identifier: Apache-2.0
/// @file
/// Where LCM's messages go: its URLs, checked before LCM takes a wrong option for some other.
#pragma once

#include <netinet/in.h>

#include <string>

namespace tauext {

/// The URL that stands for "": $LCM_DEFAULT_URL, else LCM's own group on this machine alone (ttl
/// 0).
std::string lcm_url(const std::string& url);

/// What is before :// in a URL: "udpm", "tcpq", "memq" or "file".
/// @throws std::invalid_argument for any other
std::string scheme_of(const std::string& url);

/// The path of a log, of file://PATH or file://PATH?..; "" of another URL.
std::string log_of(const std::string& url);

/// A udpm:// URL.
struct GroupUrl {
  sockaddr_in place{};                   ///< multicast group and port
  int ttl = 0;                           ///< [hops] 0: this machine alone
  int receive_buffer = 2 * 1024 * 1024;  ///< [bytes] that the kernel keeps while a receiver is busy
};

/// @throws std::invalid_argument for another scheme, a place that is no multicast group, or an
/// unknown option
GroupUrl group_url(const std::string& url);

}  // namespace tauext
