// SPDX-License-Identifier: Apache-2.0
#include "mjcf/trace/printable.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <cstdio>

namespace tauext {
namespace {

// bytes of the character at the front, 0 if it is none: RFC 3629, without C1's controls
std::size_t character(std::string_view s) {
  const auto byte = [&](std::size_t i) { return static_cast<std::uint8_t>(s[i]); };
  const std::uint8_t first = byte(0);
  if (first < 0x80) return first < 0x20 || first == 0x7f ? 0 : 1;
  const std::size_t size = first >= 0xc2 && first < 0xe0   ? 2
                           : first >= 0xe0 && first < 0xf0 ? 3
                           : first >= 0xf0 && first < 0xf5 ? 4
                                                           : 0;
  if (size == 0 || s.size() < size) return 0;
  std::uint32_t code = first & (0xffu >> (size + 1));
  for (std::size_t i = 1; i < size; ++i) {
    if ((byte(i) & 0xc0) != 0x80) return 0;
    code = code << 6 | (byte(i) & 0x3fu);
  }
  constexpr std::uint32_t kLeast[] = {0, 0, 0xa0, 0x800, 0x10000};
  const bool surrogate = code >= 0xd800 && code < 0xe000;
  // what turns the direction of writing hides text as a control sequence does
  const bool turns = (code >= 0x202a && code <= 0x202e) || (code >= 0x2066 && code <= 0x2069);
  return code < kLeast[size] || code > 0x10ffff || surrogate || turns ? 0 : size;
}

}  // namespace

std::string printable(std::string_view text) {
  std::string out;
  while (!text.empty()) {
    const std::size_t size = text[0] == '\n' ? 1 : character(text);
    if (size == 0) out += '?';
    out += text.substr(0, size);
    text.remove_prefix(size == 0 ? 1 : size);
  }
  return out;
}

void say(std::string_view line) {
  const char* const clear = ::isatty(STDERR_FILENO) == 1 ? "\r\033[K" : "";
  fmt::print(stderr, "{}{}\n", clear, printable(line));
}

std::string printable_name(std::string_view text, std::size_t most) {
  std::string out = printable(text.substr(0, most));
  for (char& c : out) {
    if (c == '\n') c = '?';
  }
  return out;
}

std::string one_line(std::string_view text, std::size_t most) {
  std::string line;
  for (const char c : printable(text.substr(0, most))) {
    if (c != '\n') {
      line += c;
    } else if (!line.empty() && !line.ends_with("; ")) {
      line += "; ";
    }
  }
  if (line.ends_with("; ")) line.resize(line.size() - 2);
  if (text.size() > most) line += " ..";
  return line;
}

}  // namespace tauext
