// SPDX-License-Identifier: Apache-2.0
/// @file
/// Work on what nobody vouches for: in a child process with limits, of which only bytes come back.
#pragma once

#include <cstddef>
#include <functional>
#include <stdexcept>
#include <string>

namespace tauext {

/// What such work may take.
struct Limits {
  double time = 30;  ///< [s] until its result is there
  std::size_t memory = std::size_t{2}
                       << 30;  ///< [bytes] more than this process has, and of a result
};

/// Work that crashed, or reached a limit.
struct Unfinished : std::runtime_error {
  using std::runtime_error::runtime_error;  ///< in words
};

/// The bytes that `work` returns, made in a child process: whatever becomes of it there, this
/// process goes on. The child writes no files and says nothing; the limit of its memory does not
/// hold under sanitizers.
/// @throws Unfinished, or a std::runtime_error with the words of what `work` throws there
std::string confined(const Limits& limits, const std::function<std::string()>& work);

}  // namespace tauext
