// SPDX-License-Identifier: Apache-2.0
/// @file
/// The rows of a recording, judged by their times as an estimator's samples are (clock.h).
#pragma once

#include <fmt/format.h>

#include <cstddef>
#include <deque>
#include <limits>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "estimators/samples/clock.h"

namespace tauext {

/// Rows of a recording that were left out, by the reason.
struct SkippedRows {
  std::string_view unit = "line";  ///< what of the file has a row: "line", "message"
  int not_finite = 0;              ///< a field was NaN, infinite or empty
  int wrong_field_count = 0;       ///< too few or too many fields
  int not_a_number = 0;            ///< a field could not be read as a number
  int time_order = 0;              ///< t was not the next one
  int alone = 0;                   ///< no row to join was near enough in time
  int set_back = 0;                ///< of the rows used, those where a clock was set back
  std::vector<std::string> first;  ///< "line 7: ...", of the first few
  std::vector<std::string> notes;  ///< the same of rows that were used, but not as they are

  /// All of them.
  int total() const { return not_finite + wrong_field_count + not_a_number + time_order + alone; }

  /// Keeps it if it is among the first.
  void say(long number, std::string_view reason) {
    if (first.size() < 3) first.push_back(fmt::format("{} {}: {}", unit, number, reason));
  }
};

/// Keeps the rows whose time is the next one, and those of a new clock. Where that was set back by
/// a second or more, time goes on a second later, since that of a trace increases; by less, rows
/// have lost their order, or come twice, and those that are no later than the last are left out,
/// unless they begin anew at the first row's time. A row comes out when those behind it cannot
/// change it any more.
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

  /// A row that came out, whose memory the next one can use; its numbers are old ones.
  std::vector<double> spare() {
    if (spare_.empty()) return {};
    std::vector<double> row = std::move(spare_.back());
    spare_.pop_back();
    return row;
  }

  /// No more rows follow.
  void finish() {
    skip_waiting();
    finished_ = true;
  }

  /// The next one of those that are kept; false if there is none yet.
  bool next(std::vector<double>& row) {
    if (kept_.empty() || (!finished_ && kept_.size() <= kUnsure)) return false;
    spare_.push_back(std::exchange(row, std::move(kept_.front().first)));
    kept_.pop_front();
    return true;
  }

 private:
  using Row = std::pair<std::vector<double>, long>;  // with its line

  static constexpr double kDisorder = 1;     // [s]
  static constexpr std::size_t kUnsure = 3;  // the last two may be left out, beside the one before

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
      if (!kept_.empty() && r.first[t_] <= kept_.back().first[t_]) {
        skip(r.second);
        continue;
      }
      if (!any_) any_ = true, first_ = r.first[t_];
      kept_.push_back(std::move(r));
    }
    waiting_.clear();
  }
  // at a clock that the rows waiting have agreed on
  void restart(double now) {
    const double begin = waiting_.empty() ? now : waiting_.front().first[t_];
    std::size_t good = kept_.size();  // unless the last two were ahead of their time
    const auto follows = [&] { return begin + shift_ > kept_[good - 1].first[t_]; };
    while (good > 0 && kept_.size() - good < 2 && !follows()) --good;
    if (good == 0 || follows()) {
      for (; kept_.size() > good; kept_.pop_back()) skip(kept_.back().second);
      return;
    }
    const double last = kept_.back().first[t_], shift = last + 1 - begin;
    if (last - shift_ - begin < kDisorder && begin > first_) {
      skipped_.notes.push_back(fmt::format(
          "{} {}: its time goes back by {:g} s; rows are left out until they are later than the "
          "last one. If a clock was set back there, or another run begins, save what follows as a "
          "log of its own",
          skipped_.unit, waiting_.front().second, last - shift_ - begin));
      return;
    }
    ++skipped_.set_back;
    skipped_.notes.push_back(fmt::format(
        "{} {}: its clock was set back by {:g} s; {:g} s are added to the times from there on",
        skipped_.unit, waiting_.front().second, last - shift_ - begin, shift));
    shift_ = shift;
  }

  Clock clock_{std::numeric_limits<double>::infinity()};
  int t_;
  SkippedRows& skipped_;
  std::deque<Row> kept_;
  bool finished_ = false;
  std::vector<Row> waiting_;
  std::vector<std::vector<double>> spare_;
  double shift_ = 0, first_ = 0;  // [s] of all rows, of the first one
  bool any_ = false;
};

}  // namespace tauext
