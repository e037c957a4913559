// SPDX-License-Identifier: Apache-2.0
/// @file
/// L0: whether two builds are the same program.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace tauext::gate {

/// A hash (FNV-1a, 64 bit) of the sections .text, .rodata and .data of an ELF file.
/// @throws std::runtime_error naming the file: unreadable, no ELF file of 64 bit, cut off
std::uint64_t code_hash(const std::string& path);

/// Whether those sections are equal, byte by byte.
/// @throws std::runtime_error as code_hash does
bool identical(const std::string& a, const std::string& b);

/// The shared libraries that an ELF file asks for by name.
/// @throws std::runtime_error as code_hash does
std::vector<std::string> needed_libraries(const std::string& path);

}  // namespace tauext::gate
