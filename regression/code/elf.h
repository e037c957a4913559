// SPDX-License-Identifier: Apache-2.0
/// @file
/// What an ELF file says of itself.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace tauext::gate {

/// The shared libraries that an ELF file asks for by name.
/// @throws std::runtime_error naming the file: unreadable, no ELF file of 64 bit, cut off
std::vector<std::string> needed_libraries(const std::string& path);

/// The name of the function that begins at that address of a shared library, as its linker knew it.
/// @throws std::runtime_error as above, and where no function does, as in a stripped file
std::string function_at(const std::string& path, std::uint64_t address);

}  // namespace tauext::gate
