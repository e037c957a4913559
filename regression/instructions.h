// SPDX-License-Identifier: Apache-2.0
/// @file
/// L1 and L1b: instructions of a step, counted by valgrind's callgrind, which repeat exactly where times do
/// not. A count means something beside one of the same compiler, flags and libraries alone: its key.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace tauext::gate {

/// What a count depends on beside the source, by name: arch, compiler, flags, eigen, glibc, libm, valgrind.
using Key = std::map<std::string, std::string>;

/// Instructions of 1,000 steps of each kernel.
struct Counts {
  Key key;
  std::map<std::string, std::uint64_t> kernels;
  /// own instructions by kernel and function; empty if read from a file
  std::map<std::string, std::map<std::string, std::uint64_t>> functions;
};

/// Runs every kernel that matches `filter` under callgrind, in a child: "count-worker" of this program, so for
/// tauext-gate alone.
/// No kernel need match.
/// @throws std::runtime_error if valgrind is missing or fails, std::regex_error for a filter that is none
Counts count_instructions(const std::string& plugin, const std::string& filter);

/// The child that runs under callgrind. @return exit code
int count_main(const std::string& plugin, const std::string& filter);

/// What one of callgrind's files says.
struct CallgrindDump {
  std::string trigger;  ///< the kernel's name, "" if it is not one of ours
  std::uint64_t total = 0;
  std::map<std::string, std::uint64_t> functions;  ///< own instructions
};

/// @param path to be named in errors
/// @throws std::runtime_error naming the path: cut off, or no file of callgrind's
CallgrindDump parse_callgrind(const std::string& text, const std::string& path);

/// <folder>/instructions-<hash of the key>.tsv
std::string counts_path(const std::string& folder, const Key& key);

/// The text of that file: header, key, then one line a kernel, sorted.
std::string format_counts(const Counts& counts);

/// @throws std::runtime_error naming the path: unreadable, empty, cut off, of another kind
Counts read_counts(const std::string& path);

/// The counts that a folder holds for a key, if it holds any.
/// @throws std::runtime_error as read_counts does, and if the file's key is not the one of its name
std::optional<Counts> committed_counts(const std::string& folder, const Key& key);

/// A kernel whose count differs.
struct CountChange {
  std::string kernel;
  std::uint64_t before = 0, after = 0;  ///< [1] instructions of 1,000 steps
  double change() const {
    return before == 0 ? (after == 0 ? 0 : 1)
                       : static_cast<double>(after) / static_cast<double>(before) - 1;
  }
  std::vector<std::string> gained;  ///< "function: +n a step", the most first
};

/// More than that fails; more than the note is said.
inline constexpr double kCountLimit = 0.01, kCountNote = 0.002;

/// Kernels of both whose count changed by any amount; `gained` where both know their functions.
/// @throws std::invalid_argument if the keys differ: such counts are never compared
std::vector<CountChange> compare_counts(const Counts& before, const Counts& after);

/// A function's name without template arguments and parameters, which fill the screen.
std::string short_name(const std::string& name);

/// "glibc: 2.36 there, 2.37 here; .." of two keys.
std::string key_difference(const Key& there, const Key& here);

}  // namespace tauext::gate
