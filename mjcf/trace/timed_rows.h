// SPDX-License-Identifier: Apache-2.0
/// @file
/// The rows of a recording, judged by their times as an estimator's samples are (clock.h).
#pragma once

#include <fmt/format.h>

#include <cstddef>
#include <limits>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "estimators/samples/clock.h"

namespace tauext {

/// Rows that read_csv left out, by the reason.
struct SkippedRows {
  int not_finite = 0;              ///< a field was NaN or infinite
  int wrong_field_count = 0;       ///< too few or too many fields
  int not_a_number = 0;            ///< a field could not be read as a number
  int time_order = 0;              ///< t was not the next one
  std::vector<std::string> first;  ///< "line 7: ...", of the first few
  std::vector<std::string> notes;  ///< the same of rows that were used, but not as they are

  /// All of them.
  int total() const { return not_finite + wrong_field_count + not_a_number + time_order; }

  /// Keeps it if it is among the first.
  void say(long line, std::string_view reason) {
    if (first.size() < 3) first.push_back(fmt::format("line {}: {}", line, reason));
  }
};

/// Keeps the rows whose time is the next one, and those of a new clock. Where that was set back,
/// time goes on a second later, since that of a trace increases.
class TimedRows {
 public:
  /// @param t the column of the time
  /// @param skipped where those that are left out are counted
  TimedRows(int t, SkippedRows& skipped) : t_(t), skipped_(skipped) {}

  /// The next row, on that line of the file.
  void take(std::vector<double> values, long line) {
    const Status status = clock_.accept(values[t_]);
    if (status == Status::kOk) skip_waiting();
    if (status == Status::kStarted) restart(values[t_]);
    waiting_.emplace_back(std::move(values), line);
    if (status != Status::kBadTime) use_waiting();
    if (static_cast<int>(waiting_.size()) < kClockSamples) return;
    skip(waiting_.front().second);
    waiting_.erase(waiting_.begin());
  }

  /// Those that were kept.
  std::vector<std::vector<double>> finish() {
    skip_waiting();
    return std::move(rows_);
  }

 private:
  using Row = std::pair<std::vector<double>, long>;

  void skip(long line) {
    ++skipped_.time_order;
    skipped_.say(line, "its time is not the next one");
  }
  void skip_waiting() {
    for (const Row& r : waiting_) skip(r.second);
    waiting_.clear();
  }
  void use_waiting() {
    for (Row& r : waiting_) {
      r.first[t_] += shift_;
      // beside a shift of 1e17 s a step is lost in the last digit
      if (!rows_.empty() && r.first[t_] <= rows_.back()[t_]) {
        skip(r.second);
        continue;
      }
      rows_.push_back(std::move(r.first));
      lines_.push_back(r.second);
    }
    waiting_.clear();
  }
  // at a clock that the rows waiting have agreed on
  void restart(double now) {
    const double begin = waiting_.empty() ? now : waiting_.front().first[t_];
    std::size_t good = rows_.size();  // unless the last two were ahead of their time
    while (good > 0 && rows_.size() - good < 2 && begin + shift_ <= rows_[good - 1][t_]) --good;
    if (good == 0 || begin + shift_ > rows_[good - 1][t_]) {
      for (std::size_t i = good; i < rows_.size(); ++i) skip(lines_[i]);
      rows_.resize(good);
      lines_.resize(good);
      return;
    }
    const double shift = rows_.back()[t_] + 1 - begin;
    skipped_.notes.push_back(fmt::format(
        "line {}: its clock was set back by {:g} s; {:g} s are added to the times from there on",
        waiting_.front().second, rows_.back()[t_] - shift_ - begin, shift));
    shift_ = shift;
  }

  Clock clock_{std::numeric_limits<double>::infinity()};
  int t_;
  SkippedRows& skipped_;
  std::vector<std::vector<double>> rows_;
  std::vector<long> lines_;  // of the file, of each of them
  std::vector<Row> waiting_;
  double shift_ = 0;  // [s]
};

}  // namespace tauext
