// SPDX-License-Identifier: Apache-2.0
/// @file
/// Files of results, as our programs write them and anybody may. Not installed.
#pragma once

#include <string>

namespace tauext {

/// A file that is what it should be.
struct ResultFile {
  std::string name;  ///< of the file, without its folder
  std::string kind;  ///< as results_schema() calls it
  std::string json;  ///< all of it; of a history, a list of its lines
};

/// What a file of each kind must be, as JSON Schema (draft 7): page/results.schema.json, with the
/// list of metrics.
std::string results_schema();

/// The text of such a file, or of a gate's history, .jsonl.
/// @throws std::runtime_error naming the path, the element and what is wrong with it
ResultFile checked_result(const std::string& path, const std::string& text);

}  // namespace tauext
