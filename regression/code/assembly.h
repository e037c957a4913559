// SPDX-License-Identifier: Apache-2.0
/// @file
/// A compiler's assembly of one file, in blocks: functions, tables and constants, and who names
/// whom.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace tauext::gate {

/// What begins at a label and ends before the next: a function with all that lies inside it, an
/// object, a constant or a table of jumps.
struct Block {
  std::string_view name;                ///< its label
  std::vector<std::string_view> lines;  ///< instructions, data and labels
  bool function = false;
  bool writable = false;  ///< a program may change it: no constant, and nothing that is relocated
};

/// As g++ and clang++ write it (-S) for a processor's own syntax.
class Assembly {
 public:
  /// @throws std::runtime_error naming the path: cut off, or no function in it
  Assembly(std::string text, const std::string& path);
  Assembly(const Assembly&) = delete;
  Assembly& operator=(const Assembly&) = delete;
  Assembly(Assembly&&) = default;

  const std::string& text() const { return *text_; }
  const std::vector<Block>& blocks() const { return blocks_; }
  /// The block that a label stands in, whether it begins it or not; nullptr if it is in none.
  const Block* find(std::string_view label) const;

  /// What a name is, by .set or by itself: a label, "" if it is none, and an offset like "+24".
  struct Meant {
    std::string_view label;
    std::string offset;
  };
  Meant meant(std::string_view name) const;

 private:
  class Reader;

  std::unique_ptr<std::string> text_;
  std::vector<Block> blocks_;
  std::map<std::string_view, std::size_t> by_label_;
  std::map<std::string_view, std::string_view> aliases_;  // and the expressions that they are
};

/// Lines of a text, without their ends.
std::vector<std::string_view> lines_of(std::string_view text);

/// The first word of a line, "" if it has none.
std::string_view first_word(std::string_view line);

/// "x" of "x:", "" of any other line.
std::string_view label_of(std::string_view line);

/// "f" of ".type f, @function", "" of any other line.
std::string_view function_of(std::string_view line);

/// Calls visit(name) for all that could be the name of a label in a line of assembly, and
/// other(text) for what is between; registers are none.
template <class Visit, class Other>
void for_each_name(std::string_view line, Visit&& visit, Other&& other) {
  const auto in_name = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
           c == '.' || c == '$';
  };
  std::size_t i = 0;
  while (i < line.size()) {
    std::size_t end = i;
    const bool name = in_name(line[i]) && !(line[i] >= '0' && line[i] <= '9') && line[i] != '$';
    if (name) {
      while (end < line.size() && in_name(line[end])) ++end;
      visit(line.substr(i, end - i));
    } else {
      // a register or a number is passed as a whole, so that nothing in it looks like a name
      ++end;
      if (line[i] == '%' || in_name(line[i])) {
        while (end < line.size() && in_name(line[end])) ++end;
      }
      other(line.substr(i, end - i));
    }
    i = end;
  }
}

}  // namespace tauext::gate
