// SPDX-License-Identifier: Apache-2.0
/// @file
/// The same assembly with its functions somewhere else.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <string>

namespace tauext::gate {

/// Names that decide where a function lies, by the function's name; one that is not there decides
/// by its own.
using LayoutNames = std::map<std::string, std::string, std::less<>>;

/// With every function at an address whose remainder mod 512 is chosen by its layout name and
/// `seed`, and with 1 to 63 bytes that nobody runs after half of its jumps and returns. Equal names
/// and seeds give equal places.
std::string laid_out(const std::string& assembly, std::uint64_t seed, const LayoutNames& names);

}  // namespace tauext::gate
