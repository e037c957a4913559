// SPDX-License-Identifier: Apache-2.0
/// @file
/// Other programs, without a shell between.
#pragma once

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <vector>

namespace tauext::gate {

/// Path of the running program.
std::string this_program();

/// The processor's name in /proc/cpuinfo, or "unknown processor".
std::string processor();

/// Runs a program (found in PATH unless it has a slash), its standard error ours.
/// @return its standard output
/// @throws std::runtime_error naming the program, if it is not there, fails or is killed
std::string run_child(const std::vector<std::string>& argv);

/// The same, with the exit code for an answer instead of an error. 127: it could not be started.
struct Finished {
  int code;
  std::string output;
};
Finished finish_child(const std::vector<std::string>& argv);

/// Starts this program again with the arguments `worker` and the request, as JSON, and reads its
/// standard output, JSON too, as a Reply.
/// @throws std::runtime_error if the child fails or answers something else
template <class Reply, class Request>
Reply ask(const std::string& worker, const Request& request) {
  const std::string out = run_child({this_program(), worker, nlohmann::json(request).dump()});
  try {
    return nlohmann::json::parse(out).get<Reply>();
  } catch (const nlohmann::json::exception& e) {
    throw std::runtime_error(fmt::format(
        "the child process '{}' did not answer with the expected JSON: {}", worker, e.what()));
  }
}

}  // namespace tauext::gate
