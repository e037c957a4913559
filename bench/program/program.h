// SPDX-License-Identifier: Apache-2.0
/// @file
/// What every program is made of: errors as one line, the share that is done.
#pragma once

#include <chrono>
#include <functional>
#include <string>
#include <vector>

#include "bench/program/exit_code.h"

namespace CLI {
class App;
}

namespace tauext {

/// Parses and runs; prints help, version and errors as "<program>: <what>"; returns the exit code.
/// @param body is called once the flags are read; what it throws becomes kCouldNotRun
int run_program(CLI::App& app, int argc, char** argv, const std::function<int()>& body);

/// Keeps freed memory in the program. Studies free and take arrays of megabytes all the time, and
/// taking each from the system would cost a tenth of their time.
void keep_freed_memory();

/// A line on a terminal's standard error with what is going on, how much of it is done, and the
/// time that is left; nothing elsewhere. Erased when it ends.
class Progress {
 public:
  explicit Progress(std::string what);  ///< what is going on
  ~Progress() { clear(); }
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// @param share 0 to 1
  void show(double share);
  /// Another line than that of a share.
  void show(const std::string& line);
  void clear();  ///< erases the line
  /// Whether anybody sees it.
  bool shown() const { return terminal_; }
  /// show() as a function for those who work; empty if nobody sees it.
  std::function<void(double)> callback();

 private:
  std::string what_;
  bool terminal_, dirty_ = false;
  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
};

/// A flag that would be ignored is one that was misunderstood.
/// @param fits whether the program runs in the mode to which the flags belong
/// @param mode in words, like "--scenario and --from"
/// @throws std::invalid_argument if it does not, and one of the flags was given
void require_mode(const CLI::App& app, bool fits, const std::string& mode,
                  const std::vector<const char*>& flags);

/// Adds --robot NAME|FILE and --lock REGEX.
void add_robot_flags(CLI::App& app, std::string& robot, std::string& lock);

/// A check for CLI11, which takes a number that does not fit for the largest that does.
/// @returns "" for a whole number from 0 to 2^64 - 1, else why not
std::string whole_number(const std::string& text);

/// A check for CLI11. @returns "" for a text that is a value; else says that it is empty, or is the
/// next flag
std::string not_empty(const std::string& text);

/// A check for CLI11. @returns "" for a regular expression of std::regex, else why it is none
std::string regular_expression(const std::string& text);

/// Whether a standard stream (STDOUT_FILENO, STDERR_FILENO) is a terminal.
bool is_terminal(int stream);

}  // namespace tauext
