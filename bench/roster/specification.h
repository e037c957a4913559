// SPDX-License-Identifier: Apache-2.0
/// @file
/// Estimators and detectors as people write them: `name[:key=value]...`, like `mo2:bandwidth=50`,
/// `ekf:integration=euler:alignment=paper` or `ndob:X=600/600/600`. Values of joints are apart by
/// slashes; one value stands for all joints. The keys are those that the Parameters list
/// (estimators/parameters.h), and `bandwidth` [rad/s] of every estimator that can be set to one.
#pragma once

#include <cstddef>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "estimators/parameters.h"
#include "estimators/types.h"

namespace tauext {

/// Keys and their values as text, in their order.
using KeyValues = std::vector<std::pair<std::string, std::string>>;

/// "key=value", taken apart.
/// @throws std::invalid_argument for text that is none
KeyValues::value_type key_and_value(std::string_view item);

/// A specification, taken apart.
struct Specification {
  std::string name;  ///< of an estimator or a detector
  KeyValues keys;    ///< in their order
};

/// @throws std::invalid_argument for text that is none: no name, a key without `=`, a key named
/// twice
Specification parse_specification(std::string_view text);

/// What stands before the first colon.
std::string_view name_of_specification(std::string_view text);

/// What it says for that key; nothing if it does not.
std::optional<std::string> key_of(std::string_view specification, std::string_view key);

/// The specification of an estimator at bandwidth w [rad/s] of its own formula.
std::string at_bandwidth(const std::string& estimator, double w);

/// What people are told of a field.
struct FieldHelp {
  std::string key, unit, range, effect;  ///< as Field has them, in words
  std::string value;  ///< unless it is set, as a specification writes it; "" where it is not known
};

/// The specification with one more key, unless the key is set, or not in `known`.
std::string with_key(const std::string& specification, const std::string& key,
                     const std::string& value, const std::vector<FieldHelp>& known);

/// "key [unit] range, .." of all fields.
std::string describe_fields(const std::vector<FieldHelp>& fields);

namespace detail {

/// "0.001 to 1e+06"
std::string range_of(double least, double most);
/// @throws std::invalid_argument naming key, value and range
double number_of(const std::string& key, std::string_view text, double least, double most);
/// The numbers between slashes: n of them, or one that stands for all.
std::vector<double> numbers_of(const std::string& key, std::string_view text, int n, double least,
                               double most);
[[noreturn]] void fail_unknown_key(const std::string& key);
[[noreturn]] void fail_choice(const std::string& key, const std::string& value,
                              const std::vector<std::string>& known);
/// @throws std::invalid_argument "<owner>: <what>; known: <fields>"
[[noreturn]] void fail_keys(std::string_view owner, const char* what,
                            const std::vector<FieldHelp>& known);

// as numbers_of reads them
std::string text_of(const double* values, int n);

template <class P, class T>
[[gnu::cold]] void add_help(const Field<P, T>& f, const P* p, const std::string& prefix,
                            std::vector<FieldHelp>& out) {
  if constexpr (std::is_enum_v<T>) {
    FieldHelp help{prefix + f.key, "", "", f.effect, ""};
    for (const auto& c : choices(T{})) {
      if (!help.range.empty()) help.range += '|';
      help.range += c.name;
      if (p != nullptr && p->*f.at == c.value) help.value = c.name;
    }
    out.push_back(std::move(help));
  } else {
    std::string value;
    if constexpr (std::is_arithmetic_v<T>) {
      const double x = p == nullptr ? 0 : static_cast<double>(p->*f.at);
      if (p != nullptr) value = text_of(&x, 1);
    } else if (p != nullptr) {
      value = text_of((p->*f.at).data(), static_cast<int>((p->*f.at).size()));
    }
    out.push_back({prefix + f.key, f.unit, range_of(f.least, f.most), f.effect, value});
  }
}

template <class P, class Inner>
void add_help(const Nested<P, Inner>& n, const P* p, const std::string& prefix,
              std::vector<FieldHelp>& out) {
  for_each_field<Inner>([&](const auto& f) {
    add_help(f, p == nullptr ? nullptr : &(p->*n.at), prefix + n.key + ".", out);
  });
}

// whether `key` was this field's; then it is set
template <class P, class T>
[[gnu::cold]] bool set_if(const Field<P, T>& f, const std::string& prefix, const std::string& key,
                          const std::string& value, P& p) {
  if (key != prefix + f.key) return false;
  if constexpr (std::is_enum_v<T>) {
    std::vector<std::string> known;
    for (const auto& c : choices(T{})) {
      if (value == c.name) return p.*f.at = c.value, true;
      known.emplace_back(c.name);
    }
    fail_choice(key, value, known);
  } else if constexpr (std::is_arithmetic_v<T>) {
    const double x = number_of(key, value, f.least, f.most);
    p.*f.at = static_cast<T>(x);
    if (static_cast<double>(p.*f.at) != x) fail_choice(key, value, {"a whole number"});
  } else {
    const int n = static_cast<int>((p.*f.at).size());
    const std::vector<double> x = numbers_of(key, value, n, f.least, f.most);
    for (int i = 0; i < n; ++i) (p.*f.at)[i] = x[static_cast<std::size_t>(i)];
  }
  return true;
}

template <class P, class Inner>
bool set_if(const Nested<P, Inner>& n, const std::string& prefix, const std::string& key,
            const std::string& value, P& p) {
  bool found = false;
  for_each_field<Inner>([&](const auto& f) {
    found = found || set_if(f, prefix + n.key + ".", key, value, p.*n.at);
  });
  return found;
}

}  // namespace detail

/// What can be set in P; nothing if it lists no fields.
/// @param p what it begins with, if that is known
template <class P>
[[gnu::cold]] std::vector<FieldHelp> field_help(const P* p = nullptr) {
  std::vector<FieldHelp> out;
  if constexpr (ListsFields<P>) {
    for_each_field<P>([&](const auto& f) { detail::add_help(f, p, "", out); });
  }
  return out;
}

/// Sets the keys in p, in their order.
/// @throws std::invalid_argument for an unknown key or a value out of range
template <class P>
[[gnu::cold]] void set_parameters(const KeyValues& keys, P& p) {
  for (const auto& item : keys) {
    bool found = false;
    if constexpr (ListsFields<P>) {
      for_each_field<P>([&](const auto& f) {
        found = found || detail::set_if(f, "", item.first, item.second, p);
      });
    }
    if (!found) detail::fail_unknown_key(item.first);
  }
}

/// What body() returns.
/// @param owner what the keys are of, as it was asked for
/// @throws std::invalid_argument what body() throws as such, with the owner and the known fields
template <class Body>
auto explaining_keys(std::string_view owner, const std::vector<FieldHelp>& known, Body&& body) {
  try {
    return body();
  } catch (const std::invalid_argument& e) {
    detail::fail_keys(owner, e.what(), known);
  }
}

namespace detail {

// what make(specification) makes of the text
template <class Make>
auto made(std::string_view text, const std::vector<FieldHelp>& fields, const Make& make) {
  const Specification s = parse_specification(text);
  if (s.keys.empty()) return make(s);
  return explaining_keys(text, fields, [&] { return make(s); });
}

// what a specification says of `bandwidth` [rad/s], which it loses
std::optional<double> take_bandwidth(Specification& s);
// with that one first
std::vector<FieldHelp> with_bandwidth(std::vector<FieldHelp> fields);
// the keys that nothing knows
void refuse_keys(const Specification& s);
// a name of a robot that two would have
[[noreturn]] void fail_taken(const char* what, const std::string& taken, const std::string& robot);

}  // namespace detail
}  // namespace tauext
