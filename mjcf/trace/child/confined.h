// SPDX-License-Identifier: Apache-2.0
/// @file
/// Runs code that a bad input may crash or hold for ever in a child process with limits.
#pragma once

#include <cstddef>
#include <functional>
#include <stdexcept>
#include <string>

namespace tauext {

/// What the child may use.
struct Limits {
  double time = 30;                             ///< [s]
  std::size_t memory = std::size_t{2} << 30;    ///< [bytes] beyond what this process has
  std::size_t result = std::size_t{256} << 20;  ///< [bytes] that come back
};

/// The work crashed or reached a limit; in words, with the work as their subject ("crashes (..)").
struct Unfinished : std::runtime_error {
  using std::runtime_error::runtime_error;  ///< its words
};

/// The bytes that `work` returns. It runs in a child process, so a crash or an endless loop ends
/// the child alone. The child cannot write into files, and what it prints is lost. This guards
/// against accidents, not against code that was written to break out. Under sanitizers memory is
/// not limited and what the child prints is kept.
/// @throws Unfinished, or a std::runtime_error with the words of the exception that `work` threw
std::string confined(const Limits& limits, const std::function<std::string()>& work);

}  // namespace tauext
