// SPDX-License-Identifier: Apache-2.0
#include "mjcf/trace/read/bag/json_message.h"

#include <fmt/compile.h>
#include <fmt/format.h>

#include <cmath>
#include <iterator>

namespace tauext {
namespace {

void append_number(double x, std::string& to) {
  if (!std::isfinite(x)) {
    to += "null";
    return;
  }
  char text[32];  // the longest has 24 letters
  const char* const end = fmt::format_to(text, FMT_COMPILE("{}"), x);
  to.append(text, static_cast<std::size_t>(end - text));
  if (x == 0 && std::signbit(x))
    to += ".0";  // -0 would be read as a whole number, which has no sign
}

}  // namespace

void JsonMessage::begin_field(std::string_view name) {
  if (text_.size() > 1) text_ += ',';
  text_ += '"';
  text_ += name;
  text_ += "\":";
}

void JsonMessage::put(std::string_view name, double x) {
  begin_field(name);
  append_number(x, text_);
}

void JsonMessage::put(std::string_view name, std::int64_t x) {
  begin_field(name);
  fmt::format_to(std::back_inserter(text_), FMT_COMPILE("{}"), x);
}

void JsonMessage::put(std::string_view name, const double* numbers, std::size_t count) {
  begin_field(name);
  text_ += '[';
  for (std::size_t i = 0; i < count; ++i) {
    if (i > 0) text_ += ',';
    append_number(numbers[i], text_);
  }
  text_ += ']';
}

std::string_view JsonMessage::finish() {
  text_ += '}';
  return text_;
}

std::string json_schema(const std::string& title, const std::vector<JsonField>& fields) {
  std::string text = fmt::format(R"({{"title":"{}","type":"object","properties":{{)", title);
  for (const JsonField& f : fields) {
    const char* const type =
        f.many ? R"("type":"array","items":{"type":"number"})" : R"("type":"number")";
    text += fmt::format(R"({}"{}":{{{},"description":"{}"}})", &f == &fields.front() ? "" : ",",
                        f.name, type, f.what);
  }
  return text + "}}";
}

}  // namespace tauext
