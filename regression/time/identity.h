// SPDX-License-Identifier: Apache-2.0
/// @file
/// L0: whether two builds are the same program.
#pragma once

#include <string>
#include <vector>

namespace tauext::gate {

/// Whether the sections .text, .rodata and .data of two ELF files are equal, byte by byte.
/// @throws std::runtime_error naming the file: unreadable, no ELF file of 64 bit, cut off
bool identical(const std::string& a, const std::string& b);

/// The shared libraries that an ELF file asks for by name.
/// @throws std::runtime_error as identical does
std::vector<std::string> needed_libraries(const std::string& path);

}  // namespace tauext::gate
