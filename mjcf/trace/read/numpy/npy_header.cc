// SPDX-License-Identifier: Apache-2.0
#include "mjcf/trace/read/numpy/npy_header.h"

#include <fmt/format.h>

#include <charconv>
#include <stdexcept>
#include <utility>

#include "mjcf/trace/printable.h"

namespace tauext {
namespace {

constexpr std::size_t kMostText = 1 << 16, kMostItem = 1 << 20;  // [bytes]
constexpr std::size_t kMostDimensions = 32;                      // NumPy's own limit

// as much of Python's literals as NumPy writes
class Parser {
 public:
  Parser(std::string_view text, const std::string& what) : text_(text), what_(what) {}

  NpyHeader header() {
    int seen = 0;
    expect('{');
    while (!take('}')) {
      const std::string key = string();
      expect(':');
      seen |= value_of(key);
      if (!take(',') && peek() != '}') fail("wants a comma");
    }
    if (seen != 7) fail("lacks one of descr, fortran_order and shape");
    if (peek() != 0) fail("goes on behind its end");
    return std::move(h_);
  }

 private:
  int value_of(const std::string& key) {
    if (key == "shape") {
      h_.shape = tuple();
      return 4;
    }
    if (key == "fortran_order") {
      h_.fortran_order = boolean();
      return 2;
    }
    if (key != "descr") fail("has an unknown key");
    h_.fields.clear();
    h_.item_size = numbers_ = 0;
    h_.structured = take('[');
    if (h_.structured) {
      while (!take(']')) field();
    } else {
      add("", string(), 1);
    }
    return 1;
  }

  // ('q', '<f8', (6,)),
  void field() {
    expect('(');
    const std::string name = string();
    expect(',');
    if (peek() == '[') fail("has a structure in a structure");
    const std::string type = string();
    std::size_t count = 1;
    if (take(',') && peek() == '(') {
      for (const std::uint64_t n : tuple()) {
        if (n > kMostItem / count) fail("has a field that is too large");
        count = count * n;
        if (count == 0) fail("has a field of nothing");
      }
      take(',');
    }
    expect(')');
    if (!take(',') && peek() != ']') fail("wants a comma");
    add(name, type, count);
  }

  void add(const std::string& name, const std::string& type, std::size_t count) {
    NpyField f{name, {}, false, count, h_.item_size};
    const std::size_t size = size_of(type, f);
    if (f.is_number) numbers_ += count;
    if (numbers_ > kMostNpyColumns) fail("has too many columns");
    if (size > (kMostItem - h_.item_size) / count) fail("has an element that is too large");
    h_.item_size += size * count;
    h_.fields.push_back(std::move(f));
  }

  // [bytes]; 0 of what has no size, which is unusable
  std::size_t size_of(const std::string& type, NpyField& f) {
    std::size_t size = 0;
    if (type.size() < 2 || std::string_view("<>|=").find(type[0]) == std::string_view::npos)
      fail("has an unknown type");
    const char* const end = type.data() + type.size();
    const auto [rest, error] = std::from_chars(type.data() + 2, end, size);
    if (error == std::errc() && rest == end && size <= kMostItem) {
      const char kind = type[1];
      f.number = {kind, static_cast<int>(size), type[0] == '>'};
      f.is_number = f.number.known();
      if (f.is_number || kind == 'S' || kind == 'V') return size;
      if (kind == 'U') return 4 * size;
    }
    if (h_.unusable.empty()) h_.unusable = type;
    return size > kMostItem ? 0 : size;
  }

  std::vector<std::uint64_t> tuple() {
    constexpr std::uint64_t kMost = std::uint64_t{1} << 40;
    std::vector<std::uint64_t> numbers;
    expect('(');
    while (!take(')')) {
      std::uint64_t n = 0;
      peek();
      const auto [rest, error] = std::from_chars(text_.data(), text_.data() + text_.size(), n);
      if (error != std::errc() || n > kMost) fail("has a shape that is none");
      if (numbers.size() == kMostDimensions) fail("has too many dimensions");
      text_.remove_prefix(static_cast<std::size_t>(rest - text_.data()));
      if (!text_.empty() && text_[0] == 'L') text_.remove_prefix(1);  // Python 2
      numbers.push_back(n);
      if (!take(',') && peek() != ')') fail("has a shape that is none");
    }
    return numbers;
  }

  bool boolean() {
    peek();
    for (const std::string_view word : {"True", "False"}) {
      if (!text_.starts_with(word)) continue;
      text_.remove_prefix(word.size());
      return word == "True";
    }
    fail("has a fortran_order that is neither True nor False");
  }

  std::string string() {
    const char quote = peek();
    if (quote != '\'' && quote != '"') fail("wants a text in quotes");
    std::string s;
    for (std::size_t i = 1; i < text_.size(); ++i) {
      if (text_[i] == quote) {
        text_.remove_prefix(i + 1);
        return s;
      }
      if (text_[i] == '\\' && ++i < text_.size() && text_[i] != '\\' && text_[i] != '\'' &&
          text_[i] != '"') {
        fail("has an escape in a name");
      }
      if (i < text_.size()) s += text_[i];
    }
    fail("has a text without its end");
  }

  // the next character that is no blank; 0 at the end
  char peek() {
    while (!text_.empty() && (text_[0] == ' ' || text_[0] == '\n')) text_.remove_prefix(1);
    return text_.empty() ? '\0' : text_[0];
  }
  bool take(char c) {
    if (peek() != c) return false;
    text_.remove_prefix(1);
    return true;
  }
  void expect(char c) {
    if (!take(c)) fail(fmt::format("wants '{}'", c));
  }
  [[noreturn]] void fail(std::string_view why) const {
    throw std::runtime_error(
        fmt::format("{}: its header {}, at '{}'", what_, why, printable_name(text_, 30)));
  }

  std::string_view text_;
  const std::string& what_;
  NpyHeader h_;
  std::size_t numbers_ = 0;  // in an element
};

}  // namespace

NpyHeader parse_npy_header(std::string_view text, const std::string& what) {
  return Parser(text, what).header();
}

NpyHeader read_npy_header(std::string_view bytes, const std::string& what) {
  const auto fail = [&](const std::string& why) {
    throw std::runtime_error(fmt::format("{}: {}", what, why));
  };
  constexpr std::string_view kMagic = "\x93NUMPY";
  constexpr std::size_t kBegin = 8;  // [bytes] with the version
  if (!bytes.starts_with(kMagic) || bytes.size() < kBegin || bytes[6] < 1 || bytes[6] > 3)
    fail("begins as no NumPy array of version 1 to 3 does");
  const std::size_t length = bytes[6] == 1 ? 2 : 4;
  if (bytes.size() < kBegin + length) fail("is cut off in its header");
  const std::size_t size = from_bytes(bytes.data() + kBegin, length);
  if (size > kMostText)
    fail(fmt::format("has a header of {} bytes, of at most {}", size, kMostText));
  if (bytes.size() < kBegin + length + size) fail("is cut off in its header");
  NpyHeader h = parse_npy_header(bytes.substr(kBegin + length, size), what);
  h.size = kBegin + length + size;
  return h;
}

}  // namespace tauext
