// SPDX-License-Identifier: Apache-2.0
/// @file
/// What a ZIP's central directory says of its members: APPNOTE.TXT of PKWARE, 4.3.12 to 4.3.16.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "mjcf/trace/read/numpy/byte_file.h"

namespace tauext {

/// A member as the directory has it; nothing of it is checked.
struct ZipMember {
  std::string name;
  bool encrypted = false;
  int method = 0;            ///< 0: stored, 8: deflated
  std::uint32_t crc = 0;     ///< of its unpacked bytes
  std::uint64_t packed = 0;  ///< [bytes] in the file
  std::uint64_t size = 0;    ///< [bytes] unpacked
  std::uint64_t header = 0;  ///< [bytes] where its local header begins
};

/// All of them, in the directory's order.
/// @throws std::runtime_error naming the path, if there is no directory, or a damaged one, or one
/// of more than 1 MB
std::vector<ZipMember> zip_members(const ByteFile& file);

/// Where the bytes of a member begin, which its local header says.
/// @throws std::runtime_error naming the path, if there is no such header
std::uint64_t zip_data(const ByteFile& file, const ZipMember& member);

}  // namespace tauext
