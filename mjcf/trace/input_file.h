// SPDX-License-Identifier: Apache-2.0
/// @file
/// Files that a program reads: none of its outputs may replace one of them.
#pragma once

#include <cstddef>
#include <string>

namespace tauext {

/// Says that a file is read, for those who read it themselves. From then on an AtomicFile refuses
/// to replace it, under whatever name.
/// @throws std::runtime_error naming the path, if it cannot be read, or if an output that is not
/// finished is to replace it
void claim_input(const std::string& path);

/// For who writes a file by other means than an AtomicFile.
/// @throws std::runtime_error naming the path, if this program reads that very file
void refuse_input(const std::string& path);

/// Says that a file that was read is to be replaced by what became of it.
void release_input(const std::string& path);

/// All bytes of a file, which is claimed.
/// @throws std::runtime_error naming path and reason: unreadable, or longer than `most` [bytes]
std::string read_whole(const std::string& path, std::size_t most = std::size_t{1} << 30);

/// The same of a file of JSON, up to 64 MiB.
/// @throws std::runtime_error also if it nests deeper than any of ours, which would end a parser
std::string read_json_text(const std::string& path);

}  // namespace tauext
