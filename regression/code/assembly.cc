// SPDX-License-Identifier: Apache-2.0
#include "regression/code/assembly.h"

#include <algorithm>
#include <memory>
#include <set>
#include <stdexcept>

namespace tauext::gate {
namespace {

bool one_of(std::string_view word, std::initializer_list<std::string_view> words) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

// "a" of "a,b" or of "a, b"
std::string_view until_comma(std::string_view text) {
  return text.substr(0, text.find_first_of(", \t"));
}

// what stands behind the first word
std::string_view operands(std::string_view line) {
  const std::string_view word = first_word(line);
  const auto at = static_cast<std::size_t>(word.data() + word.size() - line.data());
  const auto begin = line.find_first_not_of(" \t", at);
  return begin == std::string_view::npos ? std::string_view() : line.substr(begin);
}

// what tells the assembler or a debugger something, and is no part of what runs
bool says_nothing(std::string_view word) {
  return word.empty() || word[0] == '#' || word.starts_with(".cfi_") ||
         one_of(word, {".file", ".loc", ".ident", ".type", ".size", ".weak", ".hidden", ".globl",
                       ".global", ".local", ".addrsig", ".addrsig_sym"});
}

}  // namespace

std::vector<std::string_view> lines_of(std::string_view text) {
  std::vector<std::string_view> lines;
  while (!text.empty()) {
    const auto end = std::min(text.find('\n'), text.size());
    lines.push_back(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return lines;
}

std::string_view first_word(std::string_view line) {
  const auto begin = line.find_first_not_of(" \t");
  if (begin == std::string_view::npos) return {};
  const auto end = line.find_first_of(" \t", begin);
  return line.substr(begin, end == std::string_view::npos ? end : end - begin);
}

std::string_view label_of(std::string_view line) {
  const auto colon = line.find(':');
  if (colon == std::string_view::npos || colon == 0 || line[0] == '\t' || line[0] == ' ') return {};
  const std::string_view label = line.substr(0, colon);
  return label.find_first_of(" \t\"#") == std::string_view::npos ? label : std::string_view();
}

// reads line by line, and knows which block a line belongs to
class Assembly::Reader {
 public:
  explicit Reader(Assembly& to) : to_(to) {}

  void read(std::string_view line) {
    const std::string_view label = label_of(line);
    if (!label.empty()) return begin(label, line);
    const std::string_view word = first_word(line);
    if (one_of(word, {".section", ".text", ".data", ".bss"})) return section(word, operands(line));
    if (word == ".type" && line.find("function") != std::string_view::npos) {
      functions_.insert(until_comma(operands(line)));
    }
    if (word == ".comm") add(until_comma(operands(line)), true);
    if (word == ".set") alias(operands(line));
    if (open_ != kNone && !says_nothing(word)) to_.blocks_[open_].lines.push_back(line);
  }

 private:
  static constexpr std::size_t kNone = static_cast<std::size_t>(-1);

  void section(std::string_view word, std::string_view what) {
    section_ = word == ".section" ? until_comma(what) : word;
    code_ = section_.starts_with(".text");
    // a function goes on behind its table of jumps
    const auto it = last_in_.find(section_);
    open_ = code_ && it != last_in_.end() ? it->second : kNone;
    const auto flags = what.find('"');
    const bool may_be_written =
        word == ".section"
            ? flags != std::string_view::npos &&
                  what.substr(flags + 1, what.find('"', flags + 1) - flags - 1).find('w') !=
                      std::string_view::npos
            : !code_;
    writable_ = may_be_written && !section_.starts_with(".data.rel.ro");
  }

  void begin(std::string_view label, std::string_view line) {
    // inside of a function labels are its own; data have a block for each
    if (!label.starts_with(".L") || !code_) open_ = last_in_[section_] = add(label, writable_);
    if (open_ == kNone) return;
    to_.by_label_[label] = open_;
    to_.blocks_[open_].lines.push_back(line);
  }

  std::size_t add(std::string_view name, bool writable) {
    to_.by_label_[name] = to_.blocks_.size();
    to_.blocks_.push_back({name, {}, functions_.contains(name), writable});
    return to_.blocks_.size() - 1;
  }

  // .set new, old
  void alias(std::string_view what) {
    const std::string_view name = until_comma(what);
    const auto comma = what.find(',');
    if (comma == std::string_view::npos) return;
    std::string_view old = what.substr(comma + 1);
    old.remove_prefix(std::min(old.find_first_not_of(" \t"), old.size()));
    const auto it = to_.by_label_.find(old);
    if (it != to_.by_label_.end()) to_.by_label_[name] = it->second;
  }

  Assembly& to_;
  std::set<std::string_view> functions_;
  std::map<std::string_view, std::size_t> last_in_;  // of each section
  std::string_view section_;
  std::size_t open_ = kNone;
  bool code_ = true, writable_ = false;
};

Assembly::Assembly(std::string text, const std::string& path)
    : text_(std::make_unique<std::string>(std::move(text))) {
  Reader reader(*this);
  for (const std::string_view line : lines_of(*text_)) reader.read(line);
  if (std::none_of(blocks_.begin(), blocks_.end(), [](const Block& b) { return b.function; })) {
    throw std::runtime_error(path + ": no assembly, or none with a function");
  }
}

const Block* Assembly::find(std::string_view label) const {
  const auto it = by_label_.find(label);
  return it == by_label_.end() ? nullptr : &blocks_[it->second];
}

}  // namespace tauext::gate
