// SPDX-License-Identifier: Apache-2.0
/// @file
/// The one answer to a name that nobody knows, and to one that is there twice.
#pragma once

#include <algorithm>
#include <cstddef>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace tauext {

/// "unknown <what> '<name>'[ of <owner>]; known: <known>, ..", to be thrown.
inline std::invalid_argument unknown(std::string_view what, std::string_view name,
                                     const std::vector<std::string>& known,
                                     std::string_view owner = "") {
  std::string text = "unknown ";
  text.append(what).append(" '").append(name).append("'");
  if (!owner.empty()) text.append(" of ").append(owner);
  text.append("; known: ");
  for (std::size_t i = 0; i < known.size(); ++i) text.append(i > 0 ? ", " : "").append(known[i]);
  return std::invalid_argument(text);
}

/// The element of that name.
/// @param name_of gives the name of an element
/// @param owner whose list it is, where there are several
/// @throws std::invalid_argument as `unknown` says it
template <class List, class NameOf>
const auto& find_known(const List& list, std::string_view what, std::string_view name,
                       NameOf&& name_of, std::string_view owner = "") {
  std::vector<std::string> known;
  for (const auto& element : list) {
    if (name_of(element) == name) return element;
    known.emplace_back(name_of(element));
  }
  throw unknown(what, name, known, owner);
}

/// @param what it is that has names, like "estimator"
/// @throws std::invalid_argument if one is there twice
inline void refuse_twice(std::string_view what, const std::vector<std::string>& names) {
  for (auto name = names.begin(); name != names.end(); ++name) {
    if (std::find(names.begin(), name, *name) == name) continue;
    throw std::invalid_argument(std::string(what) + " '" + *name + "' is named twice");
  }
}

}  // namespace tauext
