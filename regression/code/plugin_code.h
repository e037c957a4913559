// SPDX-License-Identifier: Apache-2.0
/// @file
/// The assembly that a plug-in is made of: who reaches what, and the same code laid out anew.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "regression/code/assembly.h"

namespace tauext::gate {

/// Names that decide where a function lies, by the function's name; one that is not there decides
/// by its own.
using LayoutNames = std::map<std::string, std::string, std::less<>>;

/// What CMake's tauext_add_plugin leaves beside a plug-in, in PLUGIN.code/.
class PluginCode {
 public:
  /// @throws std::runtime_error naming what is missing or is no such file
  explicit PluginCode(const std::string& plugin);

  /// All that a function reaches, itself, what it calls and the constants and tables that it reads,
  /// and what these do, with names that say nothing of how they were chosen: equal where two
  /// functions do the same by the same instructions in the same order. Functions of other libraries
  /// are there by name alone. "" where memory is reached that can change while the program runs, so
  /// that nobody knows what a call through it calls, or a local label that is nowhere.
  /// @throws std::runtime_error if there is no such function
  std::string reached(const std::string& function) const;

  /// A function's own instructions without any name, by the function's name.
  std::map<std::string, std::string> shapes() const;

  /// Assembles and links it into `out`, laid out anew: every function at an address whose remainder
  /// mod 512 is chosen by its layout name and `seed`, and with 1 to 63 bytes that nobody runs after
  /// half of its jumps and returns. Equal names and seeds give equal places.
  /// @throws std::runtime_error with what the compiler said
  void lay_out(std::uint64_t seed, const LayoutNames& names, const std::string& out) const;

  const std::string& path() const { return path_; }

 private:
  std::string path_;    // of the plug-in
  std::string folder_;  // to link in
  std::vector<std::string> link_;
  std::vector<Assembly> units_;
};

/// Names for head's functions, so that one that is base's but for its name lies where base's does.
LayoutNames paired_names(const PluginCode& base, const PluginCode& head);

}  // namespace tauext::gate
