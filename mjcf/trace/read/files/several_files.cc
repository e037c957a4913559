// SPDX-License-Identifier: Apache-2.0
#include "mjcf/trace/read/files/several_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <numeric>
#include <regex>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "mjcf/trace/printable.h"
#include "mjcf/trace/text.h"

namespace tauext {
namespace {

namespace fs = std::filesystem;

// what one of the files tells of the rows that it has skipped
void add_words(SkippedRows& to, const SkippedRows& from, const std::string& file) {
  constexpr std::size_t kShown = 3;
  for (const std::string& line : from.first)
    if (to.first.size() < kShown) to.first.push_back(printable_name(file) + kOfFile + line);
  for (const std::string& note : from.notes)
    to.notes.push_back(printable_name(file) + kOfFile + note);
}

struct Part {
  long number;  // 0: it has none
  std::string name;
};

std::vector<Part> parts_of(const std::string& folder, const std::string& expression) {
  std::vector<Part> all;
  const std::regex wanted(expression);
  std::error_code error;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    const std::string name = it->path().filename().string();
    std::smatch match;
    constexpr std::size_t kLongest = 255;
    if (name.size() > kLongest || !std::regex_match(name, match, wanted)) continue;
    all.push_back({match.size() > 1 ? number_in<long>(match[1].str()).value_or(0) : 0, name});
  }
  if (error)
    throw std::runtime_error(fmt::format(
        "{}: `parts` of the map of columns are files in a folder: {}", folder, error.message()));
  if (all.empty())
    throw std::runtime_error(fmt::format(
        "{}: no file's whole name matches `parts = '{}'` of the map", folder, expression));
  std::sort(all.begin(), all.end(), [](const Part& a, const Part& b) {
    return std::pair(a.number, a.name) < std::pair(b.number, b.name);
  });
  const auto twice = std::adjacent_find(all.begin(), all.end(), [](const Part& a, const Part& b) {
    return a.number == b.number && a.number != 0;
  });
  if (twice != all.end())
    throw std::runtime_error(fmt::format("{}: '{}' and '{}' are both part {}", folder,
                                         printable_name(twice->name),
                                         printable_name(std::next(twice)->name), twice->number));
  return all;
}

class Parts final : public RowSource {
 public:
  Parts(const std::string& folder, const std::string& expression, OpenRows open)
      : folder_(folder), open_(std::move(open)), parts_(parts_of(folder, expression)) {
    rows_ = open_(path());
    columns_ = rows_->columns();
    wanted_.resize(columns_.size());
    std::iota(wanted_.begin(), wanted_.end(), 0);
  }

  const std::vector<std::string>& columns() const override { return columns_; }
  void read_only(const std::vector<int>& wanted) override {
    wanted_ = wanted;
    rows_->read_only(wanted);
  }
  bool next(std::vector<double>& row, SkippedRows& skipped) override {
    while (rows_ != nullptr) {
      SkippedRows here;
      here.unit = unit();
      const bool any = rows_->next(row, here);
      skipped.not_finite += here.not_finite, skipped.wrong_field_count += here.wrong_field_count;
      skipped.not_a_number += here.not_a_number, skipped.time_order += here.time_order;
      add_words(skipped, here, parts_[part_].name);
      if (any) {
        if (repeats_last(row)) continue;
        keep(row);
        return true;
      }
      open_next();
      if (rows_ == nullptr && repeated_ > 0)
        skipped.notes.push_back(fmt::format(
            "{} of {} parts begin with the last row of the one before, which is left out there",
            repeated_, parts_.size()));
    }
    return false;
  }
  long number() const override { return rows_ == nullptr ? 0 : rows_->number(); }
  std::string_view unit() const override { return rows_ == nullptr ? "row" : rows_->unit(); }

 private:
  std::string path() const { return (fs::path(folder_) / parts_[part_].name).string(); }

  std::string first_difference(const std::vector<std::string>& others) const {
    const auto [ours, theirs] =
        std::mismatch(columns_.begin(), columns_.end(), others.begin(), others.end());
    const auto name = [](auto at, auto end) {
      return at == end ? std::string("none") : "'" + printable_name(*at) + "'";
    };
    return fmt::format("column {} is {}, and there {}", ours - columns_.begin() + 1,
                       name(theirs, others.end()), name(ours, columns_.end()));
  }

  void keep(const std::vector<double>& row) {
    last_.clear();
    for (const int c : wanted_) last_.push_back(row[static_cast<std::size_t>(c)]);
  }

  // as long as every part has begun so, for rows that an arm at rest repeats are its own
  bool repeats_last(const std::vector<double>& row) {
    if (!begins_) return false;
    begins_ = false;
    overlap_ =
        overlap_ && std::equal(last_.begin(), last_.end(), wanted_.begin(), [&](double was, int c) {
          return row[static_cast<std::size_t>(c)] == was;
        });
    repeated_ += overlap_ ? 1 : 0;
    return overlap_;
  }

  void open_next() {
    rows_.reset();
    if (++part_ == parts_.size()) return;
    begins_ = true;
    rows_ = open_(path());
    if (rows_->columns() != columns_)
      throw std::runtime_error(fmt::format("{}: its columns are not those of '{}': {}", path(),
                                           printable_name(parts_.front().name),
                                           first_difference(rows_->columns())));
    rows_->read_only(wanted_);
  }

  std::string folder_;
  OpenRows open_;
  std::vector<Part> parts_;
  std::size_t part_ = 0;
  std::unique_ptr<RowSource> rows_;  // of that part
  std::vector<std::string> columns_;
  std::vector<int> wanted_;
  std::vector<double> last_;  // what was wanted of the row before
  bool begins_ = false, overlap_ = true;
  int repeated_ = 0;
};

class SideBySide final : public RowSource {
 public:
  SideBySide(const std::string& folder, const std::string& first,
             const std::vector<std::string>& files, const OpenRows& open) {
    if (!first.empty()) open_one(first, "", open);
    for (const std::string& file : files) {
      const std::string path = (fs::path(folder) / file).string();
      open_one(path, file + kOfFile, open);
    }
  }

  const std::vector<std::string>& columns() const override { return columns_; }
  void read_only(const std::vector<int>& wanted) override {
    find_twins(wanted);
    std::vector<int> others;
    for (const Twin& twin : twins_) others.push_back(twin.other);
    for (File& f : files_) {
      f.rows->read_only(f.own(wanted));
      f.rows->look_at(f.own(others));
    }
  }
  bool next(std::vector<double>& row, SkippedRows& skipped) override {
    if (ended_) return false;
    const std::int64_t wanted = ++row_;
    bad_fields_ = false;
    for (bool level = false; !level;) {
      level = true;
      for (File& f : files_) {
        while (f.at < row_)
          if (!read(f, skipped)) return finish(f, wanted, skipped);
        level = level && f.at == row_;
        row_ = std::max(row_, f.at);
      }
    }
    count(row_ - wanted, skipped);
    row.clear();
    for (const File& f : files_) row.insert(row.end(), f.row.begin(), f.row.end());
    for (Twin& twin : twins_) twin.take(row);
    return true;
  }
  long number() const override { return files_.front().rows->number(); }
  std::string_view unit() const override { return files_.front().rows->unit(); }

 private:
  struct File {
    std::string path;
    std::unique_ptr<RowSource> rows;
    int begin;            // its first column
    std::int64_t at = 0;  // which row it is, from 1, with those that could not be read
    std::vector<double> row;
    int columns() const { return static_cast<int>(rows->columns().size()); }
    std::string name() const { return fs::path(path).filename().string(); }
    bool has(int c) const { return c >= begin && c < begin + columns(); }
    std::vector<int> own(const std::vector<int>& all) const {
      std::vector<int> some;
      for (const int c : all)
        if (has(c)) some.push_back(c - begin);
      return some;
    }
  };
  // a column that is read of the file with the time, and one of that name in another file that is
  // not read
  struct Twin {
    int one, other;
    std::string name, where, elsewhere;  // the files of both
    double least = kNever, most = -kNever, apart = 0;

    void take(const std::vector<double>& row) {
      const double a = row[static_cast<std::size_t>(one)], b = row[static_cast<std::size_t>(other)];
      if (!std::isfinite(a) || !std::isfinite(b)) return;
      least = std::min(least, a), most = std::max(most, a);
      apart = std::max(apart, std::abs(a - b));
    }
  };

  static constexpr double kNever = std::numeric_limits<double>::infinity();

  void find_twins(const std::vector<int>& wanted) {
    twins_.clear();
    const auto is_wanted = [&](int c) {
      return std::find(wanted.begin(), wanted.end(), c) != wanted.end();
    };
    const auto each_column = [this](auto&& visit) {
      for (const File& f : files_)
        for (int k = 0; k < f.columns(); ++k)
          visit(f, f.begin + k, f.rows->columns()[static_cast<std::size_t>(k)]);
    };
    each_column([&](const File& f, int one, const std::string& name) {
      if (!is_wanted(one) || !f.has(wanted.front())) return;
      each_column([&](const File& g, int other, const std::string& its) {
        if (&f != &g && its == name && !is_wanted(other))
          twins_.push_back({one, other, name, f.name(), g.name()});
      });
    });
  }

  // of twins that are more apart than by rounding, or by the times of two topics
  void note_twins(SkippedRows& skipped) const {
    constexpr double kSame = 0.01;  // [1] of what a column varies by
    for (const Twin& twin : twins_)
      if (twin.apart > 0 && twin.apart > kSame * (twin.most - twin.least))
        return skipped.notes.push_back(fmt::format(
            "column '{}' of {} is up to {:.3g} away from that of {}: are these files of one "
            "recording?",
            printable_name(twin.name), printable_name(twin.elsewhere), twin.apart,
            printable_name(twin.where)));
  }

  void open_one(const std::string& path, const std::string& prefix, const OpenRows& open) {
    files_.push_back({path, open(path), static_cast<int>(columns_.size()), 0, {}});
    for (const std::string& name : files_.back().rows->columns()) columns_.push_back(prefix + name);
  }

  bool read(File& f, SkippedRows& skipped) {
    SkippedRows here;
    here.unit = f.rows->unit();
    const bool any = f.rows->next(f.row, here);
    f.at += here.total() + (any ? 1 : 0);
    bad_fields_ = bad_fields_ || here.wrong_field_count > 0;
    add_words(skipped, here, f.name());
    return any;
  }

  // rows that some of the files could not read
  void count(std::int64_t rows, SkippedRows& skipped) const {
    (bad_fields_ ? skipped.wrong_field_count : skipped.not_a_number) += static_cast<int>(rows);
  }

  // one of them is at its end, as all must be
  bool finish(const File& ended, std::int64_t wanted, SkippedRows& skipped) {
    ended_ = true;
    note_twins(skipped);
    count(ended.at - wanted + 1, skipped);
    for (File& f : files_) {
      if (&f == &ended) continue;
      while (f.at < ended.at && read(f, skipped)) {
      }
      if (f.at > ended.at || read(f, skipped))
        throw std::runtime_error(
            fmt::format("{}: has {} rows, and {} has more: are they of one "
                        "recording, with a header each or none?",
                        ended.path, ended.at, f.path));
    }
    return false;
  }

  std::vector<File> files_;
  std::vector<Twin> twins_;
  std::vector<std::string> columns_;
  std::int64_t row_ = 0;
  bool ended_ = false, bad_fields_ = false;
};

}  // namespace

std::unique_ptr<RowSource> parts_in(const std::string& folder, const std::string& expression,
                                    const OpenRows& open) {
  return std::make_unique<Parts>(folder, expression, open);
}

std::unique_ptr<RowSource> side_by_side(const std::string& folder, const std::string& first,
                                        const std::vector<std::string>& files,
                                        const OpenRows& open) {
  return std::make_unique<SideBySide>(folder, first, files, open);
}

}  // namespace tauext
