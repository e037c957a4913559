// SPDX-License-Identifier: Apache-2.0
/// @file
/// Errors of robots' files that flags mend, and words of the commands that do it.
#pragma once

#include <set>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>

namespace tauext {

/// Flags of tauext-import, beside those that were given.
struct Mending {
  std::set<std::string> lock;  ///< joints to fix, by name
  bool balance = false;        ///< ImportOptions::balance

  bool empty() const { return lock.empty() && !balance; }
  void add(const Mending& other) {
    lock.insert(other.lock.begin(), other.lock.end());
    balance = balance || other.balance;
  }
};

/// An error that names all that is wrong, and the flags that mend it, or some of it.
class Mendable : public std::runtime_error {
 public:
  Mendable(const std::string& words, Mending by) : std::runtime_error(words), by_(std::move(by)) {}

  const Mending& by() const { return by_; }

 private:
  Mending by_;
};

/// A word in the quotes that a shell takes away.
inline std::string shell_quoted(std::string_view word) {
  std::string out = "'";
  for (const char c : word) out += c == '\'' ? "'\\''" : std::string(1, c);
  return out + '\'';
}

/// A path as a word of a command line: in quotes where it needs them.
inline std::string shell_word(const std::string& path) {
  const bool plain = path.find_first_of(" '\"$`\\()&;<>|*?[]#~!{}") == path.npos;
  return plain ? path : shell_quoted(path);
}

}  // namespace tauext
