// SPDX-License-Identifier: Apache-2.0
#include "bench/tune/keys.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace tauext {
namespace {

const FieldHelp* find(const std::vector<FieldHelp>& fields, const std::string& key) {
  const auto it =
      std::find_if(fields.begin(), fields.end(), [&](const FieldHelp& f) { return f.key == key; });
  return it == fields.end() ? nullptr : &*it;
}

std::string keys_in_words(const std::string& of, const std::vector<FieldHelp>& fields) {
  return fields.empty() ? of + " has no parameters" : of + ": " + describe_fields(fields);
}

// of each joint, or of all; none if it is no number
std::vector<double> numbers_in(const std::string& key, const std::string& text) {
  constexpr double kMost = std::numeric_limits<double>::max();
  try {
    const auto n = std::count(text.begin(), text.end(), '/') + 1;
    return detail::numbers_of(key, text, static_cast<int>(n), -kMost, kMost);
  } catch (const std::invalid_argument&) {
    return {};
  }
}

}  // namespace

double TunedKey::largest_start() const {
  return *std::max_element(start.begin(), start.end());
}

std::vector<TunedKey> keys_of(const std::vector<std::string>& texts, const TunedPair& pair,
                              const std::vector<FieldHelp>& of_estimator,
                              const std::vector<FieldHelp>& of_detector) {
  std::vector<TunedKey> keys;
  for (const std::string& text : texts) {
    const std::size_t equals = text.find('='),
                      colon = text.find(':', std::min(equals, text.size()));
    TunedKey k;
    k.key = text.substr(0, equals);
    const FieldHelp* const e = find(of_estimator, k.key);
    const FieldHelp* const d = pair.detector.empty() ? nullptr : find(of_detector, k.key);
    if ((e == nullptr) == (d == nullptr))
      throw std::invalid_argument(fmt::format(
          "--tune {}: {}; {}{}", text,
          e != nullptr            ? "both have that key"
          : pair.detector.empty() ? "unknown key"
                                  : "neither has that key",
          keys_in_words(pair.estimator, of_estimator),
          pair.detector.empty() ? "" : "; " + keys_in_words(pair.detector, of_detector)));
    k.of_detector = d != nullptr;
    const FieldHelp& field = d != nullptr ? *d : *e;
    if (field.unit.empty())
      throw std::invalid_argument(fmt::format(
          "--tune {}: a choice ({}) cannot be tuned; tune with each of them", text, field.range));
    k.whole = field.unit == "samples";
    const auto set = key_of(d != nullptr ? pair.detector : pair.estimator, k.key);
    k.start = numbers_in(k.key, set.value_or(field.value));
    if (equals != text.npos) {
      const std::vector<double> low =
                                    numbers_in(k.key, text.substr(equals + 1, colon - equals - 1)),
                                high = colon == text.npos
                                           ? low
                                           : numbers_in(k.key, text.substr(colon + 1));
      if (low.size() != 1 || high.size() != 1 || !(0 < low[0] && low[0] < high[0]))
        throw std::invalid_argument(
            fmt::format("--tune {}: KEY=LOW:HIGH, with 0 < LOW < HIGH", text));
      k.low = low[0], k.high = high[0];
      if (!set && (k.start.empty() || !(k.largest_start() > 0)))
        k.start = {std::sqrt(k.low) * std::sqrt(k.high)};
    }
    if (k.start.empty() || !(k.largest_start() > 0))
      throw std::invalid_argument(fmt::format(
          "--tune {}: no number above 0 to begin with; {}={} says where it lies, or set it in the "
          "specification",
          text, k.key, "LOW:HIGH"));
    if (k.high > 0 && (k.largest_start() < k.low || k.largest_start() > k.high))
      throw std::invalid_argument(
          fmt::format("--tune {}: the start, {:g}, is not between these", text, k.largest_start()));
    if (k.high == 0) k.low = k.largest_start() / 30, k.high = k.largest_start() * 30;
    keys.push_back(std::move(k));
  }
  return keys;
}

TunedPair without(const TunedPair& pair, const std::vector<TunedKey>& keys) {
  const auto stripped = [&](const std::string& text, bool of_detector) {
    if (text.empty()) return text;
    const Specification s = parse_specification(text);
    std::string out = s.name;
    for (const KeyValues::value_type& set : s.keys) {
      const bool tuned = std::any_of(keys.begin(), keys.end(), [&](const TunedKey& k) {
        return k.key == set.first && k.of_detector == of_detector;
      });
      if (!tuned) out += ":" + set.first + "=" + set.second;
    }
    return out;
  };
  return {stripped(pair.estimator, false), stripped(pair.detector, true)};
}

}  // namespace tauext
