// SPDX-License-Identifier: Apache-2.0
/// @file
/// Rows that have a part of a sample each, as messages of several topics have, joined by their
/// times.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <iterator>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "mjcf/trace/timed_rows.h"

namespace tauext {

/// Makes samples of rows in which numbers are missing (NaN). The rows of one number, the pace, give
/// each a sample and its time; what such a row does not have is taken from the row nearest in time
/// that does, the earlier of two, if it is near enough. Rows may come out of order by up to 0.25 s,
/// but for those that have the same number. As TimedRows does, it leaves out a row whose time is
/// beside those around it, and takes three in a row for a new clock, over which nothing is joined.
class JoinedRows {
 public:
  /// @param path of the recording, for what is thrown
  /// @param within [s] how far apart joined rows may be
  /// @param names of the numbers in a row, the first of which is the time [s]
  /// @param pace which of them it is
  /// @param skipped where samples that are not whole are counted, and rows that are left out
  JoinedRows(std::string path, double within, std::vector<std::string> names, std::size_t pace,
             SkippedRows& skipped)
      : path_(std::move(path)),
        within_(within),
        names_(std::move(names)),
        pace_(pace),
        skipped_(skipped),
        last_(names_.size(), -kNever),
        taken_(names_.size()) {}

  /// The next row, on that line of the file.
  /// @throws std::runtime_error where more rows are of one time than anything records
  void take(std::vector<double> values, long line) {
    if (!std::isfinite(values[0])) {
      ++skipped_.not_finite;
      skipped_.say(line, "the time is not finite");
      return;
    }
    const auto missing = [](double x) { return std::isnan(x); };
    if (std::all_of(values.begin() + 1, values.end(), missing)) {
      ++strange_;
      return;
    }
    if (follows(values)) {
      skip_waiting();
      insert({std::move(values), line});
      decide(newest_ - reach(newest_) - kLate);
      return;
    }
    if (!waiting_.empty() && !follows_waiting(values)) skip_waiting();
    waiting_.push_back({std::move(values), line});
    if (static_cast<int>(waiting_.size()) < kClockSamples) return;
    finish_clock();
    for (Row& r : waiting_) insert(std::move(r));
    waiting_.clear();
  }

  /// No more rows follow.
  void finish() {
    skip_waiting();
    finish_clock();
  }

  /// The next sample that is whole, on the line of the row that gives its time; false if there is
  /// none yet.
  bool next(std::vector<double>& values, long& line) {
    if (joined_.empty()) return false;
    values = std::move(joined_.front().values);
    line = joined_.front().line;
    joined_.pop_front();
    return true;
  }

  /// At the end: what was taken from where, and what is left over.
  std::string in_words() const {
    std::string all = fmt::format("joined by time (join = {:g} s): {} samples at the times of {}",
                                  within_, samples_, quantity(pace_));
    for (std::size_t i = 1; i < names_.size(); ++i)
      if (is_worst(i))
        all += fmt::format("; {} taken from {:.3g} ms {} on average, at most {:.3g} ms away",
                           quantity(i), 1e3 * std::abs(taken_[i].sum) / count(),
                           taken_[i].sum < 0 ? "earlier" : "later", 1e3 * taken_[i].most);
    if (reused_ > 0) all += fmt::format("; {} rows serve more than one sample", reused_);
    if (unused_ > 0)
      all += fmt::format("; {} rows serve none, {} of them as there is no {} within {:g} s of them",
                         unused_, alone_, quantity(pace_), within_);
    if (strange_ > 0) all += fmt::format("; {} rows have nothing of a sample", strange_);
    return all;
  }

 private:
  struct Row {
    std::vector<double> values;
    long line = 0;
    int used = 0;       // how often
    bool near = false;  // to a sample's time
    double t() const { return values[0]; }
  };
  // where a number was taken from
  struct Taken {
    double sum = 0, most = 0;  // [s] from the samples' times, and away from them
  };

  static constexpr double kNever = std::numeric_limits<double>::infinity();
  static constexpr double kLate = 0.25;          // [s] how late a row may come, and how far ahead
  static constexpr std::size_t kMost = 1 << 17;  // rows of this time

  static bool has(const Row& r, std::size_t i) { return !std::isnan(r.values[i]); }

  // whether the row is of this clock, and behind those that have the same numbers
  bool follows(const std::vector<double>& values) const {
    const double t = values[0];
    if (window_.empty() && newest_ == -kNever) return true;
    if (!(std::abs(t - newest_) <= kLate)) return false;
    for (std::size_t i = 1; i < values.size(); ++i)
      if (!std::isnan(values[i]) && t <= last_[i]) return false;
    return true;
  }
  bool follows_waiting(const std::vector<double>& values) const {
    return std::all_of(waiting_.begin(), waiting_.end(), [&](const Row& r) {
      bool same = false;
      for (std::size_t i = 1; i < values.size(); ++i)
        same = same || (has(r, i) && !std::isnan(values[i]));
      return std::abs(values[0] - r.t()) <= kLate && (!same || values[0] > r.t());
    });
  }
  void skip_waiting() {
    for (const Row& r : waiting_) {
      ++skipped_.time_order;
      skipped_.say(r.line, "its time is not the next one");
    }
    waiting_.clear();
  }

  void insert(Row row) {
    const double t = row.t();
    newest_ = std::max(newest_, t);
    for (std::size_t i = 1; i < names_.size(); ++i)
      if (has(row, i)) last_[i] = t;
    auto at = window_.end();
    while (at != window_.begin() && std::prev(at)->t() > t) --at;
    window_.insert(at, std::move(row));
    if (window_.size() > kMost)
      throw std::runtime_error(
          fmt::format("{}: {} {}: more than {} rows in half a second: is the time in another unit?",
                      path_, skipped_.unit, window_.back().line, kMost));
  }

  // makes the samples of earlier times, of which all rows have come by now
  void decide(double until) {
    for (; decided_ < window_.size() && window_[decided_].t() < until; ++decided_)
      if (has(window_[decided_], pace_)) join(decided_);
    for (; !window_.empty() && window_.front().t() < until - reach(until); --decided_) drop();
  }
  void finish_clock() {
    decide(kNever);
    while (!window_.empty()) drop();
    decided_ = 0;
    newest_ = -kNever;
    std::fill(last_.begin(), last_.end(), -kNever);
  }

  // [s] as far as rows are joined, with the rounding of two times
  double reach(double t) const {
    return within_ + 2 * std::numeric_limits<double>::epsilon() * std::abs(t);
  }

  void join(std::size_t at) {
    Row sample{window_[at].values, window_[at].line};
    from_.assign(names_.size(), at);
    const double t = sample.t(), most = reach(t);
    for (std::size_t before = at, behind = at + 1;;) {
      const double past = before > 0 ? t - window_[before - 1].t() : kNever;
      const double future = behind < window_.size() ? window_[behind].t() - t : kNever;
      if (std::min(past, future) > most) break;
      const std::size_t nearest = past <= future ? --before : behind++;
      window_[nearest].near = true;
      for (std::size_t i = 1; i < names_.size(); ++i) {
        if (has(sample, i) || !has(window_[nearest], i)) continue;
        sample.values[i] = window_[nearest].values[i];
        from_[i] = nearest;
      }
    }
    window_[at].near = true;
    keep(std::move(sample), at);
  }

  // if it is whole
  void keep(Row sample, std::size_t at) {
    for (std::size_t i = 1; i < names_.size(); ++i) {
      if (has(sample, i)) continue;
      ++skipped_.alone;
      skipped_.say(sample.line, fmt::format("no {} within {:g} s", names_[i], within_));
      return;
    }
    ++samples_;
    for (std::size_t i = 1; i < names_.size(); ++i) {
      const double away = window_[from_[i]].t() - window_[at].t();
      taken_[i].sum += away;
      taken_[i].most = std::max(taken_[i].most, std::abs(away));
    }
    from_.push_back(at);
    std::sort(from_.begin(), from_.end());
    from_.erase(std::unique(from_.begin(), from_.end()), from_.end());
    for (const std::size_t i : from_) ++window_[i].used;
    joined_.push_back(std::move(sample));
  }

  void drop() {
    const Row& r = window_.front();
    reused_ += r.used > 1;
    unused_ += r.used == 0 && !has(r, pace_);
    alone_ += r.used == 0 && !r.near;
    window_.pop_front();
  }

  // "[q]" of "[q] of joint 2"
  std::string quantity(std::size_t i) const { return names_[i].substr(0, names_[i].find(' ')); }
  // whether this number of its quantity was taken from farthest away
  bool is_worst(std::size_t i) const {
    if (taken_[i].most == 0) return false;
    for (std::size_t j = 1; j < names_.size(); ++j) {
      const bool worse =
          taken_[j].most > taken_[i].most || (taken_[j].most == taken_[i].most && j < i);
      if (worse && quantity(j) == quantity(i)) return false;
    }
    return true;
  }
  double count() const { return static_cast<double>(std::max<std::int64_t>(samples_, 1)); }

  std::string path_;
  double within_;  // [s]
  std::vector<std::string> names_;
  std::size_t pace_;
  SkippedRows& skipped_;
  std::deque<Row> window_;    // by time
  std::size_t decided_ = 0;   // of these
  double newest_ = -kNever;   // [s] of this clock
  std::vector<double> last_;  // [s] of each number
  std::vector<Row> waiting_;  // which may be of a new clock
  std::vector<std::size_t> from_;
  std::deque<Row> joined_;
  std::vector<Taken> taken_;
  std::int64_t samples_ = 0, reused_ = 0, unused_ = 0, alone_ = 0, strange_ = 0;
};

}  // namespace tauext
