// SPDX-License-Identifier: Apache-2.0
/// @file
/// What touches the arm in a scenario of a file (scenario_file.h). Not installed.
#pragma once

#include <fmt/format.h>

#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "mjcf/import/json_object.h"
#include "mjcf/scenarios/regions.h"
#include "mjcf/scenarios/touch.h"
#include "mjcf/trace/known.h"

namespace tauext {

/// Ends reading.
/// @throws std::invalid_argument with these words
template <class... Args>
[[noreturn]] void refuse(fmt::format_string<Args...> words, Args&&... args) {
  throw std::invalid_argument(fmt::format(words, std::forward<Args>(args)...));
}

/// What a word of an object stands for, of a list of pairs.
/// @throws std::invalid_argument for an unknown one, listing the known ones
template <class Choices>
auto choice(const JsonObject& o, const char* key, const std::string& word, const Choices& all) {
  try {
    return find_known(all, key, word, [](const auto& c) { return std::string(c.first); }).second;
  } catch (const std::invalid_argument& e) {
    refuse("{}: {}", o.where(), e.what());
  }
}

/// Its "touches": prescribed forces on the end effector.
/// @param duration [s] of the scenario
/// @throws std::invalid_argument naming what is wrong, and where
std::vector<Touch> touches_of(const JsonObject& o, double duration);

/// Its "regions": of a person's body that meet the arm.
/// @throws std::invalid_argument likewise
std::vector<RegionTouch> regions_of(const JsonObject& o, double duration);

}  // namespace tauext
