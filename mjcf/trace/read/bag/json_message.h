// SPDX-License-Identifier: Apache-2.0
/// @file
/// Messages of numbers as JSON, and what a JSON schema says of them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace tauext {

/// A message that is being written. Numbers have as many digits as tell them from others; where one
/// is not finite, JSON has no number, and it is null.
class JsonMessage {
 public:
  /// Begins the next one.
  void clear() { text_ = "{"; }
  /// Adds a number, a whole one, or an array.
  /// @param name plain letters
  void put(std::string_view name, double x);
  void put(std::string_view name, std::int64_t x);                            ///< likewise
  void put(std::string_view name, const double* numbers, std::size_t count);  ///< likewise
  /// Ends it. The text stays until clear().
  std::string_view finish();

 private:
  void begin_field(std::string_view name);

  std::string text_ = "{";
};

/// A field of a message, for people and for viewers.
struct JsonField {
  std::string name;   ///< by which messages have it
  bool many = false;  ///< an array of numbers; else one
  std::string what;   ///< it is, with its unit
};

/// The JSON schema of such messages. A number is called one though it may be null, as viewers want
/// a single type.
/// @param title the name of the type
std::string json_schema(const std::string& title, const std::vector<JsonField>& fields);

}  // namespace tauext
