// SPDX-License-Identifier: Apache-2.0
/// @file
/// Counted instructions of a step: as a file, and beside others, also line by line. A count means
/// something beside one of the same compiler, flags and libraries alone: its key.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace tauext::gate {

/// What a count depends on beside the source, by name: arch, compiler, flags, eigen, glibc, libm,
/// valgrind.
using Key = std::map<std::string, std::string>;

inline constexpr int kCountedSteps = 1000;

/// Instructions by file and line, as the compiler says where they come from.
using LineCounts = std::map<std::pair<std::string, int>, std::uint64_t>;

/// Instructions of so many steps of each kernel.
struct Counts {
  Key key;
  std::map<std::string, std::uint64_t> kernels;
  /// own instructions by kernel and function; empty if read from a file
  std::map<std::string, std::map<std::string, std::uint64_t>> functions;
  /// the same by source line, of what was compiled with lines
  std::map<std::string, LineCounts> lines;
};

/// <folder>/instructions-<hash of the key>.tsv
std::string counts_path(const std::string& folder, const Key& key);

/// The text of that file: header, key, then one line a kernel, sorted.
std::string format_counts(const Counts& counts);

/// @throws std::runtime_error naming the path: unreadable, empty, cut off, of another kind
Counts read_counts(const std::string& path);

/// The counts that a folder holds for a key, if it holds any.
/// @throws std::runtime_error as read_counts does, and if the file's key is not the one of its name
std::optional<Counts> committed_counts(const std::string& folder, const Key& key);

/// Lines that execute more or less than they did.
struct LineChange {
  std::string file;
  int line = 0;         ///< the first of head's, or the one behind those that are gone
  std::int64_t by = 0;  ///< instructions more, all steps together
};

/// What differs, the most first. Lines have moved where a commit put others before them, so those
/// of equal counts are paired in their order, as many as can be, and what is left between two pairs
/// is one change.
std::vector<LineChange> changed_lines(const LineCounts& before, const LineCounts& after);

/// A kernel whose count differs.
struct CountChange {
  std::string kernel;
  std::uint64_t before = 0, after = 0;  ///< [1] instructions of kCountedSteps
  double change() const {
    return before == 0 ? (after == 0 ? 0 : 1)
                       : static_cast<double>(after) / static_cast<double>(before) - 1;
  }
  /// "+n a step at file:line", or "in function" where nobody knows the lines; the most first
  std::vector<std::string> gained;
  std::string accepted;  ///< why it is right; "" if nobody says so
};

/// More than that fails; more than the note is said.
inline constexpr double kCountLimit = 0.01, kCountNote = 0.002;

/// Kernels of both whose count changed by any amount; `gained` where both know lines or functions.
/// @throws std::invalid_argument if the keys differ: such counts are never compared
std::vector<CountChange> compare_counts(const Counts& before, const Counts& after);

/// Kernels of both whose count differs, whatever the keys.
std::set<std::string> counted_otherwise(const Counts& before, const Counts& after);

/// Whether a count grew beyond the limit, and nobody accepted it.
bool too_many(const CountChange& change);

/// A function's name without template arguments and parameters, which fill the screen.
std::string short_name(const std::string& name);

/// Of one step what so many instructions are of kCountedSteps.
double a_step(std::int64_t instructions);

/// A count as it stands in a file. @throws std::runtime_error naming the path: no whole number
std::uint64_t whole_count(const std::string& text, const std::string& path);

/// "glibc: 2.36 there, 2.37 here; .." of two keys.
std::string key_difference(const Key& there, const Key& here);

}  // namespace tauext::gate
