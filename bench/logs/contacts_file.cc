// SPDX-License-Identifier: Apache-2.0
#include "bench/logs/contacts_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "mjcf/trace/input_file.h"
#include "mjcf/trace/known.h"
#include "mjcf/trace/printable.h"
#include "mjcf/trace/read/recording.h"
#include "mjcf/trace/text.h"

namespace tauext {
namespace {

namespace fs = std::filesystem;

struct ContactKind {
  std::string_view name;
  std::uint8_t what;
};
constexpr ContactKind kKinds[] = {
    {"collision", 1}, {"accidental", 1}, {"intended", kIntended}, {"intentional", kIntended}};

constexpr double kRounded = 0.1;  // [s] by which a label may pass the end of its recording

// apart by this; what stands in "" may have it, too
std::vector<std::string> fields_of(std::string_view line, char separator) {
  std::vector<std::string> fields(1);
  bool quoted = false;
  for (const char c : line) {
    if (c == '"') {
      quoted = !quoted;
    } else if (c == separator && !quoted) {
      fields.emplace_back();
    } else {
      fields.back() += c;
    }
  }
  for (std::string& f : fields) f = std::string(without_blanks(f));
  return fields;
}

std::string not_read(const std::vector<std::string>& files) {
  constexpr std::size_t kShown = 3;
  std::string some;
  for (std::size_t i = 0; i < std::min(files.size(), kShown); ++i)
    some += (i == 0 ? "'" : ", '") + printable_name(files[i]) + "'";
  return fmt::format("{} file{} not read: {}{}", files.size(),
                     files.size() == 1 ? " that is" : "s that are", some,
                     files.size() > kShown ? ", .." : "");
}

// without a "/" at the end of a folder
std::string name_in(const std::string& path) {
  const fs::path p(path);
  return (p.has_filename() ? p : p.parent_path()).filename().string();
}

std::string real_path(const fs::path& path) {
  std::error_code none;
  return fs::weakly_canonical(path, none).string();
}

}  // namespace

ContactsFile::ContactsFile(const std::string& path, const std::vector<std::string>& logs)
    : path_(path) {
  for (const std::string& log : logs) logs_.push_back({log, real_path(log), name_in(log), {}});
  constexpr std::size_t kMost = 1 << 26;  // [bytes]
  read(read_whole(path, kMost));
  for (OfLog& log : logs_) {
    if (log.free > 0 && !log.contacts.empty())
      fail(log.free, fmt::format("says that nothing touches the arm in '{}', and line {} has a "
                                 "contact of it",
                                 printable_name(log.name), log.contacts.front().line));
    require_apart(log);
    if (log.named) continue;
    throw std::invalid_argument(fmt::format(
        "{0}: has no line for {1}; where nothing touches the arm in it, say so by a line without "
        "times: {2},,",
        path, log.log, log.name));
  }
}

void ContactsFile::fail(long line, const std::string& what) const {
  throw std::invalid_argument(one_line(fmt::format("{}: line {}: {}", path_, line, what)));
}

void ContactsFile::read(const std::string& text) {
  long line = 0;
  char separator = ',';
  std::vector<std::string> names, others;  // files that are not read
  std::ptrdiff_t at[4]{};                  // where file, start, end and kind stand
  std::string_view rest(text);
  if (rest.starts_with("\xEF\xBB\xBF")) rest.remove_prefix(3);
  for (const std::string_view one : split(rest, '\n')) {
    ++line;
    if (without_blanks(one).empty() || one.front() == '#') continue;
    if (names.empty()) {
      for (const char c : {';', '\t'})
        if (one.find(c) != one.npos) separator = c;
      names = fields_of(one, separator);
      constexpr const char* kColumns[] = {"file", "start", "end", "kind"};
      for (int i = 0; i < 4; ++i) {
        at[i] = std::find(names.begin(), names.end(), kColumns[i]) - names.begin();
        if (i < 3 && at[i] == std::ssize(names))
          fail(line, fmt::format("has no column '{}': the first line is file,start,end or "
                                 "file,start,end,kind",
                                 kColumns[i]));
      }
      continue;
    }
    const std::vector<std::string> fields = fields_of(one, separator);
    if (fields.size() != names.size())
      fail(line,
           fmt::format("{} fields, and the first line names {}", fields.size(), names.size()));
    const auto field = [&](int i) {
      return at[i] < std::ssize(fields) ? fields[static_cast<std::size_t>(at[i])] : std::string();
    };
    OfLog* const log = find(field(0), line);
    if (log == nullptr && std::find(others.begin(), others.end(), field(0)) == others.end())
      others.push_back(field(0));
    const bool is_free = field(1).empty() && field(2).empty();
    if (log != nullptr) log->named = true, log->free = is_free ? line : log->free;
    if (is_free) continue;
    const auto from = finite_number_in(field(1)), to = finite_number_in(field(2));
    if (!from || !to)
      fail(line, fmt::format("'{}' to '{}' are no times [s]", printable_name(field(1)),
                             printable_name(field(2))));
    LabelledContact c{.from = *from, .to = *to, .line = line};
    if (c.to < c.from)
      fail(line, fmt::format("ends at {} s, before its start at {} s", c.to, c.from));
    try {
      if (const std::string kind = field(3); !kind.empty())
        c.what =
            find_known(kKinds, "kind of contact", kind, [](const auto& k) { return k.name; }).what;
    } catch (const std::invalid_argument& e) {
      fail(line, e.what());
    }
    if (log != nullptr) log->contacts.push_back(c);
  }
  if (names.empty()) throw std::invalid_argument(path_ + ": is empty: no line names the columns");
  if (!others.empty()) say(path_ + ": left out what it has of " + not_read(others));
}

ContactsFile::OfLog* ContactsFile::find(const std::string& file, long line) {
  std::vector<OfLog*> by_path, by_name;
  const std::string here = real_path(file),
                    beside = real_path(fs::path(path_).parent_path() / file);
  for (OfLog& log : logs_) {
    if (log.canonical == here || log.canonical == beside) by_path.push_back(&log);
    if (log.name == file) by_name.push_back(&log);
  }
  std::vector<OfLog*>& found = by_path.empty() ? by_name : by_path;
  if (found.empty()) return nullptr;
  if (found.size() > 1)
    fail(line, fmt::format("'{}' is more than one of the recordings: name its path",
                           printable_name(file)));
  return found[0];
}

void ContactsFile::require_apart(OfLog& log) const {
  std::vector<LabelledContact>& all = log.contacts;
  std::stable_sort(all.begin(), all.end(),
                   [](const auto& a, const auto& b) { return a.from < b.from; });
  const auto overlap = std::adjacent_find(all.begin(), all.end(), [](const auto& a, const auto& b) {
    return b.from < a.to || b.from == a.from;
  });
  if (overlap == all.end()) return;
  const LabelledContact &a = *overlap, &b = *std::next(overlap);
  fail(std::max(a.line, b.line),
       fmt::format("{} to {} s overlaps line {}, {} to {} s", a.line > b.line ? a.from : b.from,
                   a.line > b.line ? a.to : b.to, std::min(a.line, b.line),
                   a.line > b.line ? b.from : a.from, a.line > b.line ? b.to : a.to));
}

const std::vector<LabelledContact>& ContactsFile::of(const std::string& log) const {
  const auto at =
      std::find_if(logs_.begin(), logs_.end(), [&](const OfLog& l) { return l.log == log; });
  if (at == logs_.end()) throw std::logic_error(log + " is not among the recordings with labels");
  return at->contacts;
}

std::shared_ptr<const ContactsFile> contacts_of(const std::string& path,
                                                const std::vector<std::string>& logs) {
  if (path.empty()) return nullptr;
  return std::make_shared<const ContactsFile>(path, logs);
}

ContactLabels::ContactLabels(const ContactsFile& file, const std::string& log)
    : file_(file), log_(log), contacts_(file.of(log)) {}

void ContactLabels::fail(const LabelledContact& c, const std::string& what) const {
  throw std::invalid_argument(
      fmt::format("{}: line {}: {} to {} s {}", file_.path(), c.line, c.from, c.to, what));
}

std::uint8_t ContactLabels::at(double t) {
  if (!std::exchange(any_, true)) {
    first_ = t;
    for (const LabelledContact& c : contacts_)
      if (c.from < t - kRounded)
        fail(c, fmt::format("begins before the first sample of {}, at {:.9g} s; times are those of "
                            "the recording, and do not begin with 0 there",
                            log_, t));
  }
  last_ = t;
  for (; next_ < contacts_.size() && contacts_[next_].to < t; ++next_)
    if (!std::exchange(seen_, false)) fail_empty(contacts_[next_]);
  const bool touched = next_ < contacts_.size() && contacts_[next_].from <= t;
  seen_ = seen_ || touched;
  return touched ? contacts_[next_].what : std::uint8_t{0};
}

void ContactLabels::finish() {
  for (; next_ < contacts_.size(); ++next_) {
    const LabelledContact& c = contacts_[next_];
    if (c.to > last_ + kRounded)
      fail(c, fmt::format("ends behind the last sample of {}, at {:.9g} s", log_, last_));
    if (!std::exchange(seen_, false)) fail_empty(c);
  }
}

void ContactLabels::fail_empty(const LabelledContact& c) const {
  fail(c, fmt::format("has no sample of {} in it, which goes from {:.9g} s on: is it in a gap?",
                      log_, first_));
}

}  // namespace tauext
