// SPDX-License-Identifier: Apache-2.0
#include "lcmtypes/receive/account.h"

#include <fmt/format.h>

#include <algorithm>

namespace tauext {
namespace {

// what the kernel dropped is ours as far as messages are missing, and all of it where nothing else
// came this way
std::int64_t our_drops(const Account& a, const GroupSocket::Counts& c) {
  const bool alone = c.unwanted + c.fragments + c.malformed + c.outside == 0;
  return alone ? c.dropped : std::min(a.lost, c.dropped);
}

}  // namespace

std::string format(const Account& a, const GroupSocket::Counts& c) {
  const std::int64_t dropped = our_drops(a, c), lost = std::max<std::int64_t>(a.lost - dropped, 0);
  std::string out = fmt::format(
      "{} sent = {} used + {} late + {} repeated + {} rejected + {} lost + {} dropped by the "
      "kernel",
      a.sent() - a.lost + lost + dropped, a.used, a.late, a.repeated, a.rejected, lost, dropped);
  if (c.dropped > dropped) {
    out += fmt::format(" (and {} more, of whichever channel)", c.dropped - dropped);
  }
  return out;
}

std::string format(const GroupSocket::Counts& c) {
  if (c.fragments + c.malformed + c.outside == 0) return "";
  return fmt::format("{} fragments, {} malformed, {} from outside this machine (ttl=1 takes them)",
                     c.fragments, c.malformed, c.outside);
}

}  // namespace tauext
