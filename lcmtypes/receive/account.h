// SPDX-License-Identifier: Apache-2.0
/// @file
/// What became of every message that was sent.
#pragma once

#include <cstdint>
#include <string>

#include "lcmtypes/receive/group_socket.h"

namespace tauext {

/// Messages, each counted once.
struct Account {
  std::int64_t used = 0;      ///< taken for what they say
  std::int64_t late = 0;      ///< overtaken by a newer one
  std::int64_t repeated = 0;  ///< that had come before
  std::int64_t rejected = 0;  ///< that are no good, or another sender's
  std::int64_t lost = 0;      ///< that never came, or did not get through the kernel

  /// All of them.
  std::int64_t sent() const { return used + late + repeated + rejected + lost; }
};

/// "505 sent = 490 used + 5 late + 0 repeated + ...". What is missing because the kernel dropped it
/// is not called lost; where nothing but our channels came this way, all that it dropped was ours.
std::string format(const Account& account, const GroupSocket::Counts& refused);

/// "3 fragments, 0 malformed, ..." if a socket refused something; else "".
std::string format(const GroupSocket::Counts& refused);

}  // namespace tauext
