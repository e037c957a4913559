// SPDX-License-Identifier: Apache-2.0
#include "bench/roster/specification.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <stdexcept>

namespace tauext {

std::string_view name_of_specification(std::string_view text) {
  return text.substr(0, text.find(':'));
}

KeyValues::value_type key_and_value(std::string_view item) {
  const auto equals = item.find('=');
  if (equals != std::string_view::npos && equals > 0 && equals + 1 < item.size()) {
    return {std::string(item.substr(0, equals)), std::string(item.substr(equals + 1))};
  }
  throw std::invalid_argument(fmt::format("'{}' is not key=value", item));
}

Specification parse_specification(std::string_view text) try {
  Specification s{std::string(name_of_specification(text)), {}};
  if (s.name.empty()) throw std::invalid_argument("it has no name");
  std::string_view rest = text.substr(s.name.size());
  while (!rest.empty()) {
    rest.remove_prefix(1);
    const std::string_view item = rest.substr(0, rest.find(':'));
    rest.remove_prefix(item.size());
    const auto set = key_and_value(item);
    if (std::any_of(s.keys.begin(), s.keys.end(),
                    [&](const auto& k) { return k.first == set.first; })) {
      throw std::invalid_argument(fmt::format("'{}' is set twice", set.first));
    }
    s.keys.push_back(set);
  }
  return s;
} catch (const std::invalid_argument& e) {
  throw std::invalid_argument(fmt::format(
      "'{}' is no specification name[:key=value]..., like mo2:bandwidth=50: {}", text, e.what()));
}

std::optional<std::string> key_of(std::string_view specification, std::string_view key) {
  for (const auto& [name, value] : parse_specification(specification).keys) {
    if (name == key) return value;
  }
  return std::nullopt;
}

std::string at_bandwidth(const std::string& estimator, double w) {
  return fmt::format("{}:bandwidth={}", estimator, w);
}

std::string with_key(const std::string& specification, const std::string& key,
                     const std::string& value, const std::vector<FieldHelp>& known) {
  const bool set = key_of(specification, key).has_value();
  const bool can =
      std::any_of(known.begin(), known.end(), [&](const FieldHelp& f) { return f.key == key; });
  return set || !can ? specification : fmt::format("{}:{}={}", specification, key, value);
}

std::string describe_fields(const std::vector<FieldHelp>& fields) {
  std::vector<std::string> all;
  for (const FieldHelp& f : fields) {
    all.push_back(f.unit.empty() ? fmt::format("{} {}", f.key, f.range)
                                 : fmt::format("{} [{}] {}", f.key, f.unit, f.range));
  }
  return fmt::format("{}", fmt::join(all, ", "));
}

namespace detail {

std::string range_of(double least, double most) {
  return fmt::format("{:g} to {:g}", least, most);
}

double number_of(const std::string& key, std::string_view text, double least, double most) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) {
    throw std::invalid_argument(fmt::format("{}={}: not a number", key, text));
  }
  if (value >= least && value <= most) return value;
  throw std::invalid_argument(
      fmt::format("{}={}: it must be {}", key, text, range_of(least, most)));
}

std::string text_of(const double* values, int n) {
  return fmt::format("{}", fmt::join(values, values + n, "/"));
}

std::vector<double> numbers_of(const std::string& key, std::string_view text, int n, double least,
                               double most) {
  std::vector<double> all;
  for (std::string_view rest = text;;) {
    const auto slash = rest.find('/');
    all.push_back(number_of(key, rest.substr(0, slash), least, most));
    if (slash == std::string_view::npos) break;
    rest.remove_prefix(slash + 1);
  }
  if (all.size() == 1) all.resize(static_cast<std::size_t>(n), all[0]);
  if (static_cast<int>(all.size()) == n) return all;
  throw std::invalid_argument(
      fmt::format("{}={}: {} values, where 1 or {} are wanted", key, text, all.size(), n));
}

void fail_unknown_key(const std::string& key) {
  throw std::invalid_argument(fmt::format("there is no key '{}'", key));
}

void fail_keys(std::string_view owner, const char* what, const std::vector<FieldHelp>& known) {
  throw std::invalid_argument(
      fmt::format("{}: {}; known: {}", owner, what,
                  known.empty() ? std::string("no keys at all") : describe_fields(known)));
}

void fail_choice(const std::string& key, const std::string& value,
                 const std::vector<std::string>& known) {
  throw std::invalid_argument(
      fmt::format("{}={}: it must be {}", key, value, fmt::join(known, " or ")));
}

std::optional<double> take_bandwidth(Specification& s) {
  const auto key = std::find_if(s.keys.begin(), s.keys.end(),
                                [](const auto& k) { return k.first == "bandwidth"; });
  if (key == s.keys.end()) return std::nullopt;
  const double w = number_of("bandwidth", key->second, kLeastBandwidth, kMostBandwidth);
  s.keys.erase(key);
  return w;
}

std::vector<FieldHelp> with_bandwidth(std::vector<FieldHelp> fields) {
  FieldHelp bandwidth{"bandwidth", "rad/s", range_of(kLeastBandwidth, kMostBandwidth),
                      "larger is faster, noisier; sets the others", ""};
  std::erase_if(fields, [&](const FieldHelp& f) {
    if (f.key == bandwidth.key) bandwidth.value = f.value;
    return f.key == bandwidth.key;
  });
  fields.insert(fields.begin(), std::move(bandwidth));
  return fields;
}

void refuse_keys(const Specification& s) {
  if (!s.keys.empty()) fail_unknown_key(s.keys.front().first);
}

void fail_taken(const char* what, const std::string& taken, const std::string& robot) {
  throw std::invalid_argument(fmt::format(
      "{} '{}' of {}: the name is taken; other parameters of it are a specification, {}:key=value",
      what, taken, robot, name_of_specification(taken)));
}

}  // namespace detail
}  // namespace tauext
