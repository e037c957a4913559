// SPDX-License-Identifier: Apache-2.0
/// @file
/// An object in a file of JSON, of which every key is known, with errors that say where.
#pragma once

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <nlohmann/json.hpp>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "mjcf/trace/input_file.h"
#include "mjcf/trace/printable.h"

namespace tauext {

/// Everything throws std::invalid_argument, which names the place, the key and the remedy.
class JsonObject {
 public:
  using Json = nlohmann::ordered_json;  ///< keys stay in order

  /// @param where it is, in words, for errors
  /// @param known the keys that it may have
  JsonObject(const Json& json, std::string where, std::initializer_list<const char*> known)
      : json_(json), where_(std::move(where)) {
    if (!json.is_object()) fail("{} is {}, no object", where_, json.dump());
    for (const auto& [key, value] : json.items()) {
      if (std::find(known.begin(), known.end(), key) == known.end())
        fail("{}: unknown key \"{}\"; known: {}", where_, key, fmt::join(known, ", "));
    }
  }

  const std::string& where() const { return where_; }              ///< as constructed
  bool has(const char* key) const { return json_.contains(key); }  ///< whether it has that key
  /// What the key has.
  const Json& at(const char* key) const {
    if (!has(key)) fail("{} has no \"{}\"", where_, key);
    return json_.at(key);
  }
  /// A number within limits.
  double number(const char* key, double least, double most) const {
    const Json& j = at(key);
    const double x = j.is_number() ? j.get<double>() : std::nan("");
    if (x >= least && x <= most) return x;
    fail("{}: \"{}\" is {}, and must be {:g} to {:g}", where_, key, j.dump(), least, most);
  }
  /// The same, with a number that stands for none.
  double number_or(const char* key, double otherwise, double least, double most) const {
    return has(key) ? number(key, least, most) : otherwise;
  }
  /// n numbers up to kMost.
  Eigen::VectorXd vector(const char* key, int n) const {
    const Json& j = at(key);
    Eigen::VectorXd v(n);
    bool good = j.is_array() && static_cast<int>(j.size()) == n;
    for (int i = 0; good && i < n; ++i) {
      good = j[static_cast<std::size_t>(i)].is_number();
      if (good) v[i] = j[static_cast<std::size_t>(i)].get<double>();
    }
    if (!good || !(v.cwiseAbs().maxCoeff() <= kMost))
      fail("{}: \"{}\" is {}, and must be {} numbers up to {:g}", where_, key, j.dump(), n, kMost);
    return v;
  }
  /// A text, or what stands for none.
  std::string text(const char* key, const std::string& otherwise) const {
    if (!has(key)) return otherwise;
    if (!at(key).is_string()) fail("{}: \"{}\" is {}, no text", where_, key, at(key).dump());
    return at(key).get<std::string>();
  }
  /// true or false; false for none.
  bool flag(const char* key) const {
    if (!has(key)) return false;
    if (!at(key).is_boolean())
      fail("{}: \"{}\" is {}, no true or false", where_, key, at(key).dump());
    return at(key).get<bool>();
  }
  /// Calls look(item, where it is) for each of a list, which may be missing.
  template <class Look>
  void each(const char* key, Look&& look) const {
    if (!has(key)) return;
    const Json& list = at(key);
    if (!list.is_array()) fail("{}: \"{}\" is {}, no list", where_, key, list.dump());
    for (std::size_t i = 0; i < list.size(); ++i)
      look(list[i], fmt::format("{}: {} {}", where_, key, i + 1));
  }

  static constexpr double kMost = 1e9;  ///< [any unit] that a number of a vector can be

 private:
  template <class... Args>
  [[noreturn]] static void fail(fmt::format_string<Args...> words, Args&&... args) {
    throw std::invalid_argument(fmt::format(words, std::forward<Args>(args)...));
  }

  const Json& json_;
  std::string where_;
};

/// What a text of JSON says, in which no object has a key twice.
/// @param comments whether it may have // and /* */
/// @throws std::invalid_argument naming a key that is there twice, or saying where it is no JSON
inline JsonObject::Json parse_json(const std::string& text, bool comments = false) {
  using Json = JsonObject::Json;
  if (text.find_first_not_of(" \t\r\n") == text.npos)
    throw std::invalid_argument("no JSON: it is empty");
  std::vector<std::set<std::string>> seen;  // of each object that is open
  const auto look = [&](int, Json::parse_event_t event, Json& parsed) {
    if (event == Json::parse_event_t::object_start) seen.emplace_back();
    if (event == Json::parse_event_t::object_end) seen.pop_back();
    if (event == Json::parse_event_t::key && !seen.back().insert(parsed.get<std::string>()).second)
      throw std::invalid_argument(fmt::format("the key {} is there twice", parsed.dump()));
    return true;
  };
  try {
    return Json::parse(text, look, true, comments);
  } catch (const Json::exception& e) {
    const std::string words = e.what();  // "[json.exception.parse_error.101] parse error at .."
    throw std::invalid_argument("no JSON: " + one_line(words.substr(words.find(']') + 2)));
  }
}

/// The same of a file.
/// @throws std::runtime_error naming the path and what is wrong
inline JsonObject::Json read_json(const std::string& path, bool comments = false) {
  const std::string text = read_json_text(path);
  try {
    return parse_json(text, comments);
  } catch (const std::invalid_argument& e) {
    throw std::runtime_error(fmt::format("{}: {}", path, e.what()));
  }
}

}  // namespace tauext
