// SPDX-License-Identifier: Apache-2.0
#include "mjcf/trace/read/text/csv_rows.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <stdexcept>

#include "mjcf/trace/printable.h"

namespace tauext {
namespace {

constexpr std::size_t kLongest = (1 << 16) - 1;  // [bytes] of a thousand numbers
constexpr std::size_t kChunk = 1 << 20;          // [bytes] read at once

bool is_blank(char c) {
  return c == ' ' || c == '\t';
}

std::string_view trimmed(std::string_view s) {
  while (!s.empty() && is_blank(s.front())) s.remove_prefix(1);
  while (!s.empty() && is_blank(s.back())) s.remove_suffix(1);
  return s;
}

std::string_view unquoted(std::string_view s) {
  s = trimmed(s);
  return s.size() >= 2 && s.front() == '"' && s.back() == '"' ? s.substr(1, s.size() - 2) : s;
}

// NaN and infinity, too; what is too large is infinite
bool number_of(std::string_view s, double& value) {
  if (!s.empty() && s.front() == '+') s.remove_prefix(1);
  const char* const end = s.data() + s.size();
  const auto [at, error] = std::from_chars(s.data(), end, value);
  if (error == std::errc::result_out_of_range) {
    value = std::numeric_limits<double>::infinity();
    return true;
  }
  if (error == std::errc() && at == end) return true;
  const bool yes = s == "True" || s == "true";
  if (!yes && s != "False" && s != "false") return false;
  value = yes ? 1 : 0;
  return true;
}

// what programs write for no number, beside nan
bool is_hole(std::string_view s) {
  constexpr std::string_view kHoles[] = {"", "NA", "N/A", "null", "None"};
  return std::find(std::begin(kHoles), std::end(kHoles), s) != std::end(kHoles);
}

bool is_comment(std::string_view line) {
  return line.starts_with('#') || line.starts_with('%');
}

// whether it is a number of those who write a comma in it
bool has_decimal_comma(std::string_view field) {
  std::string text(field);
  const std::size_t comma = text.find(',');
  double value = 0;
  if (comma == text.npos) return false;
  text[comma] = '.';
  return number_of(text, value);
}

// what to do about a field that is no number, if that is known
const char* remedy_of(std::string_view field) {
  if (has_decimal_comma(field)) return ": write decimals with a point";
  const bool is_time = field.find(':') != field.npos && field[0] >= '0' && field[0] <= '9';
  return is_time ? ": times are numbers, of seconds or a unit that the map says; `rate` [Hz] in a "
                   "map of columns counts the rows instead"
                 : "";
}

[[noreturn]] void fail_line_ends(const std::string& path) {
  throw std::runtime_error(
      fmt::format("{0}: its lines end in CR, and not in LF: tr '\\r' '\\n' < {0} > run.csv", path));
}

// the one that the line has, of those that are usual
char separator_of(std::string_view line) {
  for (const char c : {',', ';', '\t'}) {
    if (line.find(c) != line.npos) return c;
  }
  return ' ';
}

}  // namespace

CsvRows::CsvRows(const std::string& path, const CsvFormat& format)
    : path_(path), format_(format), file_(path), buffer_(kChunk + kLongest + 1) {
  read_header();
  wanted_.assign(columns_.size(), Use::kNumber);
}

// false at the end of the file
bool CsvRows::refill() {
  if (at_end_) return false;
  std::copy(buffer_.begin() + static_cast<std::ptrdiff_t>(begin_),
            buffer_.begin() + static_cast<std::ptrdiff_t>(end_), buffer_.begin());
  end_ -= begin_;
  begin_ = 0;
  const std::size_t got = file_.read(buffer_.data() + end_, kChunk);
  end_ += got;
  at_end_ = got == 0;
  return !at_end_;
}

bool CsvRows::next_line(std::string_view& line) {
  std::size_t seen = 0;  // of what is left, without a line end
  for (;;) {
    const char* const from = buffer_.data() + begin_;
    const void* const found = std::memchr(from + seen, '\n', end_ - begin_ - seen);
    const std::size_t size = found == nullptr
                                 ? end_ - begin_
                                 : static_cast<std::size_t>(static_cast<const char*>(found) - from);
    if (size > kLongest) {
      if (number_ == 0 && std::memchr(from, '\r', size) != nullptr) fail_line_ends(path_);
      throw std::runtime_error(fmt::format("{}: line {} is longer than {} bytes: no CSV of ours",
                                           path_, number_ + 1, kLongest));
    }
    if (found == nullptr && refill()) {
      seen = size;
      continue;
    }
    if (found == nullptr && size == 0) return false;
    cut_off_ = found == nullptr;
    line = {buffer_.data() + begin_, size};
    begin_ += size + (cut_off_ ? 0 : 1);
    ++number_;
    if (line.ends_with('\r')) line.remove_suffix(1);
    return true;
  }
}

// the next field; whether another one follows
bool CsvRows::take_field(std::string_view& rest, std::string_view& field) const {
  const bool blanks = format_.separator == ' ';
  if (blanks) rest = trimmed(rest);
  const std::size_t end = blanks ? rest.find_first_of(" \t") : rest.find(format_.separator);
  field = unquoted(rest.substr(0, end));
  if (end == rest.npos) return false;
  rest.remove_prefix(end + 1);
  return true;
}

// that says something; Excel's sep=; says what is between fields
std::string_view CsvRows::first_line() {
  for (std::string_view line;;) {
    if (!next_line(line))
      throw std::runtime_error(path_ + (number_ == 0 ? ": is empty" : ": has no rows"));
    if (line.find('\r') != line.npos) fail_line_ends(path_);
    if (number_ == 1 && line.starts_with("\xEF\xBB\xBF")) line.remove_prefix(3);
    if (line.starts_with("sep=") && line.size() == 5) {
      if (format_.separator == 0) format_.separator = line[4];
    } else if (!trimmed(line).empty()) {
      return line;
    }
  }
}

void CsvRows::unread(std::string_view line) {
  begin_ = static_cast<std::size_t>(line.data() - buffer_.data());
  --number_;
}

void CsvRows::read_header() {
  std::string_view line = first_line();
  while (!format_.has_header && is_comment(trimmed(line))) line = first_line();
  std::string names(trimmed(line));
  while (format_.has_header && is_comment(names)) {  // the last one before numbers has the names
    const std::string_view more = first_line();
    double value = 0;
    std::string_view begin = trimmed(more);
    if (number_of(begin.substr(0, begin.find_first_of(std::string(",; \t") + format_.separator)),
                  value)) {
      unread(more);
      names.erase(0, 1);
      break;
    }
    names = begin;
  }
  if (format_.separator == 0) format_.separator = separator_of(names);
  std::string_view rest = trimmed(names);
  std::map<std::string, int> times;
  std::string_view field;
  for (bool more = true; more;) {
    more = take_field(rest, field);
    const int before = times[std::string(field)]++;
    columns_.push_back(!format_.has_header ? fmt::format("{}", columns_.size() + 1)
                       : before > 0        ? fmt::format("{}#{}", field, before + 1)
                                           : std::string(field));
  }
  double value = 0;
  if (format_.has_header && number_of(columns_.front(), value)) {
    throw std::runtime_error(fmt::format(
        "{}: begins with numbers: the first line must name the columns, like t,q1,qd1,tau1",
        path_));
  }
  if (!format_.has_header) unread(line);  // it is a row, too
}

void CsvRows::read_only(const std::vector<int>& wanted) {
  wanted_.assign(columns_.size(), Use::kNone);
  for (const int c : wanted) wanted_[static_cast<std::size_t>(c)] = Use::kNumber;
}

void CsvRows::look_at(const std::vector<int>& columns) {
  for (const int c : columns) wanted_[static_cast<std::size_t>(c)] = Use::kIfNumber;
}

// the row's numbers, or why it cannot be used
std::string CsvRows::parse(std::string_view line, std::vector<double>& row,
                           SkippedRows& skipped) const {
  bool all_finite = true;
  std::string wrong;
  std::size_t fields = 0;
  for (bool more = true; more; ++fields) {
    std::string_view field;
    more = take_field(line, field);
    if (fields >= columns_.size() || wanted_[fields] == Use::kNone) continue;
    double& value = row[fields];
    if (wanted_[fields] == Use::kIfNumber) {
      if (!number_of(field, value)) value = std::numeric_limits<double>::quiet_NaN();
      continue;
    }
    if (format_.holes && is_hole(field)) {
      value = std::numeric_limits<double>::quiet_NaN();
    } else if (!number_of(field, value) && wrong.empty()) {
      wrong = fmt::format("column '{}' is '{}', not a number{}", printable_name(columns_[fields]),
                          printable_name(std::string(field)), remedy_of(field));
    }
    if (!std::isfinite(value)) all_finite = false;
  }
  if (fields != columns_.size()) {
    ++skipped.wrong_field_count;
    return fmt::format("fields: {}, columns: {}", fields, columns_.size());
  }
  if (!wrong.empty()) {
    ++skipped.not_a_number;
    return wrong;
  }
  if (all_finite || !format_.finite) return {};
  ++skipped.not_finite;
  return "a field is not finite";
}

bool CsvRows::next(std::vector<double>& row, SkippedRows& skipped) {
  row.assign(columns_.size(), std::numeric_limits<double>::quiet_NaN());
  for (std::string_view line; next_line(line);) {
    if (line.empty() || is_comment(line)) continue;
    std::string reason = parse(line, row, skipped);
    if (cut_off_) {  // and so may be its last number
      if (reason.empty()) ++skipped.wrong_field_count;
      reason = "the last line has no end: the file may be cut off there";
    }
    if (reason.empty()) return true;
    skipped.say(number_, reason);
  }
  return false;
}

}  // namespace tauext
