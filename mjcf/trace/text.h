// SPDX-License-Identifier: Apache-2.0
/// @file
/// What stands in a text: numbers, and parts of it.
#pragma once

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

namespace tauext {

/// The number that the whole text is, as std::from_chars reads it: with a point, and without blanks
/// or a plus before it. Nothing of any other text, and of a number that is out of T's range.
template <class T>
std::optional<T> number_in(std::string_view text) noexcept {
  T x{};
  const char* const end = text.data() + text.size();
  const auto [at, error] = std::from_chars(text.data(), end, x);
  return error == std::errc() && at == end ? std::optional(x) : std::nullopt;
}

/// The same, if it is neither infinite nor NaN.
inline std::optional<double> finite_number_in(std::string_view text) noexcept {
  const std::optional<double> x = number_in<double>(text);
  return x && std::isfinite(*x) ? x : std::nullopt;
}

/// The text without the blanks, tabs and carriage returns around it.
inline std::string_view without_blanks(std::string_view text) noexcept {
  constexpr std::string_view kBlanks = " \t\r";
  text.remove_prefix(std::min(text.find_first_not_of(kBlanks), text.size()));
  return text.substr(0, text.find_last_not_of(kBlanks) + 1);
}

/// What stands between separators, which is nothing where two of them meet.
inline std::vector<std::string_view> split(std::string_view text, char separator) {
  std::vector<std::string_view> parts;
  for (;;) {
    const std::size_t end = text.find(separator);
    parts.push_back(text.substr(0, end));
    if (end == text.npos) return parts;
    text.remove_prefix(end + 1);
  }
}

/// The text with small letters for A to Z.
inline std::string in_small_letters(std::string_view text) {
  std::string small(text);
  for (char& c : small) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return small;
}

}  // namespace tauext
