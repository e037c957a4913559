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
                       ".global", ".local", ".set", ".addrsig", ".addrsig_sym"});
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

std::string_view function_of(std::string_view line) {
  if (first_word(line) != ".type") return {};
  const std::string_view what = operands(line), name = until_comma(what);
  return what.substr(name.size()).find("function") == what.npos ? std::string_view() : name;
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
    if (const std::string_view function = function_of(line); !function.empty()) {
      functions_.insert(function);
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
    std::string_view old = what.substr(std::min(what.find(',') + 1, what.size()));
    old.remove_prefix(std::min(old.find_first_not_of(" \t"), old.size()));
    to_.aliases_[until_comma(what)] = old;
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
  // the last that a compiler says
  if (!text_->ends_with('\n') || text_->find(".note.GNU-stack") == std::string::npos) {
    throw std::runtime_error(path + ": cut off, or no assembly of g++ or clang++; build it anew");
  }
  Reader reader(*this);
  for (const std::string_view line : lines_of(*text_)) reader.read(line);
  if (std::none_of(blocks_.begin(), blocks_.end(), [](const Block& b) { return b.function; })) {
    throw std::runtime_error(path + ": holds no function");
  }
}

const Block* Assembly::find(std::string_view label) const {
  const auto it = by_label_.find(label);
  return it == by_label_.end() ? nullptr : &blocks_[it->second];
}

Assembly::Meant Assembly::meant(std::string_view name) const {
  Meant m{name, ""};
  // no alias is longer a way than there are aliases; more would be a circle
  std::size_t steps = 0;
  for (auto it = aliases_.find(name); it != aliases_.end() && steps++ < aliases_.size();
       it = aliases_.find(m.label)) {
    const auto end = std::min(it->second.find_first_of("+- \t"), it->second.size());
    m = {it->second.substr(0, end), std::string(it->second.substr(end)) + m.offset};
  }
  return by_label_.contains(m.label) ? m : Meant();
}

}  // namespace tauext::gate
