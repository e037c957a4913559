// SPDX-License-Identifier: Apache-2.0
#include "bench/outside/estimates_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <regex>
#include <stdexcept>

#include "mjcf/trace/printable.h"
#include "mjcf/trace/read/recording.h"

namespace tauext {
namespace {

// of one estimator in a row
struct Columns {
  std::map<int, int> tau_ext;  // by joint, from 1
  int mark = -1, status = -1;
  std::string detector;
};

// by the estimator's name; "" where the file has none
using Named = std::map<std::string, Columns>;

class Finder {
 public:
  Finder(const std::vector<std::string>& columns, int joints) : columns_(columns) {
    for (int i = 0; i < static_cast<int>(columns.size()); ++i) find_torque(i);
    if (all_.empty() && is_bare(joints)) {
      for (int j = 0; j < joints; ++j) all_[""].tau_ext[j + 1] = j;
    }
    for (int i = 0; i < static_cast<int>(columns.size()); ++i) find_rest(i);
  }

  Named all_;
  int t_ = -1;

 private:
  const std::string& name(int i) const { return columns_[static_cast<std::size_t>(i)]; }

  void find_torque(int i) {
    static const std::regex kTorque(R"((?:(.+)_)?tau_ext_?(\d+))");
    std::smatch m;
    if (name(i) == "t") t_ = i;
    if (std::regex_match(name(i), m, kTorque))
      all_[m[1].str()].tau_ext[std::atoi(m[2].str().c_str())] = i;
  }

  // a matrix of nothing else
  bool is_bare(int joints) const {
    return static_cast<int>(columns_.size()) == joints && columns_.front() == "1";
  }

  void find_rest(int i) {
    const bool mark = name(i) == "mark" || name(i).ends_with("_mark");
    for (auto& [estimator, columns] : all_) {
      const std::string prefix = estimator.empty() ? "" : estimator + "_";
      if (name(i) == prefix + "status") columns.status = i;
      const bool own = name(i).starts_with(prefix) && !prefix.empty();
      if (!mark || !(own || all_.size() == 1)) continue;
      columns.mark = i;
      const std::string rest = own ? name(i).substr(prefix.size()) : name(i);
      columns.detector = rest == "mark" ? "marks" : rest.substr(0, rest.size() - 5);
    }
  }

  const std::vector<std::string>& columns_;
};

// puts rows to samples: each to the one whose time is nearest
class Samples {
 public:
  explicit Samples(const Trace& trace) : t_(trace.t) {}

  // of a time [s]; -1: none is nearer than half a step
  int at(double t) {
    while (next_ + 1 < t_.size() && t_[next_ + 1] - t <= t - t_[next_]) ++next_;
    while (next_ > 0 && t - t_[next_ - 1] < t_[next_] - t) --next_;
    const double before = next_ > 0 ? t_[next_] - t_[next_ - 1] : step(0);
    const double behind = next_ + 1 < t_.size() ? step(next_) : before;
    const double most = std::min(before, behind) / 2;
    return std::abs(t - t_[next_]) <= most ? static_cast<int>(next_) : -1;
  }

 private:
  double step(std::size_t k) const { return k + 1 < t_.size() ? t_[k + 1] - t_[k] : 1; }

  const std::vector<double>& t_;
  std::size_t next_ = 0;
};

// the estimates of all estimators, as the rows come
class Collector {
 public:
  Collector(const std::string& path, const std::string& name, const Finder& found,
            const Trace& trace)
      : path_(path), found_(found), trace_(trace), samples_(trace) {
    for (const auto& [estimator, columns] : found.all_) {
      OutsideEstimates e{estimator.empty() ? name : estimator, columns.detector, {}};
      require_joints(e.estimator, columns);
      const auto samples = static_cast<std::size_t>(trace.size());
      e.output.tau_ext = Eigen::MatrixXd::Zero(trace.dof(), trace.size());
      e.output.status.assign(samples, Status::kBadTime);
      if (columns.mark >= 0) e.output.marks.assign(samples, 0);
      all_.push_back(std::move(e));
    }
  }

  void take(const std::vector<double>& row) {
    const int k = found_.t_ < 0 ? row_ : samples_.at(row[static_cast<std::size_t>(found_.t_)]);
    ++row_;
    if (k < 0 || k >= trace_.size()) {
      ++elsewhere_;
      return;
    }
    std::size_t i = 0;
    for (const auto& [name, columns] : found_.all_) fill(all_[i++].output, columns, row, k);
  }

  std::vector<OutsideEstimates> finish() {
    if (row_ == 0) throw std::runtime_error(path_ + ": no row of numbers");
    if (found_.t_ < 0 && row_ != trace_.size())
      throw std::runtime_error(
          fmt::format("{}: {} rows without times, and {} samples: a column t says which belong "
                      "together",
                      path_, row_, trace_.size()));
    if (2 * elsewhere_ > row_)
      throw std::runtime_error(
          fmt::format("{}: {} of its {} rows are at times of no sample; the log goes from {:g} to "
                      "{:g} s: is the "
                      "file of another log?",
                      path_, elsewhere_, row_, trace_.t.front(), trace_.t.back()));
    for (OutsideEstimates& e : all_) finish(e);
    return std::move(all_);
  }

 private:
  void require_joints(const std::string& name, const Columns& columns) const {
    const int n = static_cast<int>(columns.tau_ext.size());
    if (n == trace_.dof() && columns.tau_ext.begin()->first == 1 &&
        columns.tau_ext.rbegin()->first == n)
      return;
    throw std::runtime_error(fmt::format("{}: {} has {} columns of tau_ext, and the log {} joints",
                                         path_, printable_name(name), n, trace_.dof()));
  }

  static void fill(Output& out, const Columns& columns, const std::vector<double>& row, int k) {
    const auto number = [&](int column) { return row[static_cast<std::size_t>(column)]; };
    for (const auto& [joint, column] : columns.tau_ext) out.tau_ext(joint - 1, k) = number(column);
    const auto at = static_cast<std::size_t>(k);
    const double said = columns.status < 0 ? 0 : number(columns.status);
    out.status[at] = said >= 0 && said < static_cast<double>(kStatusCount)
                         ? static_cast<Status>(static_cast<int>(said))
                         : Status::kBadMeasurement;
    if (columns.mark >= 0) out.marks[at] = number(columns.mark) != 0;
  }

  void finish(OutsideEstimates& e) const {
    Output& o = e.output;
    std::int64_t none = 0;
    for (int k = 0; k < trace_.size(); ++k) {
      const auto at = static_cast<std::size_t>(k);
      if (o.status[at] == Status::kBadTime) {
        ++none;
        if (k > 0) o.tau_ext.col(k) = o.tau_ext.col(k - 1);
      }
      o.counts.add(o.status[at], 0);
    }
    if (2 * none <= trace_.size()) return;
    throw std::runtime_error(fmt::format(
        "{}: {} of the {} samples have no estimate of {}; the log goes from {:g} to {:g} s: is the "
        "file of another log?",
        path_, none, trace_.size(), printable_name(e.estimator), trace_.t.front(),
        trace_.t.back()));
  }

  const std::string& path_;
  const Finder& found_;
  const Trace& trace_;
  Samples samples_;
  std::vector<OutsideEstimates> all_;
  int row_ = 0, elsewhere_ = 0;
};

}  // namespace

std::vector<OutsideEstimates> read_estimates(const std::string& path, const std::string& name,
                                             const Trace& trace) {
  const std::unique_ptr<RowSource> rows = open_rows(path, {}, {.finite = false});
  const Finder found(rows->columns(), trace.dof());
  if (found.all_.empty())
    throw std::runtime_error(path + ": no columns tau_ext1, tau_ext2, .. or NAME_tau_ext1, ..");
  std::vector<int> wanted{};
  if (found.t_ >= 0) wanted.push_back(found.t_);
  for (const auto& [estimator, columns] : found.all_) {
    for (const auto& [joint, column] : columns.tau_ext) wanted.push_back(column);
    for (const int column : {columns.mark, columns.status}) {
      if (column >= 0) wanted.push_back(column);
    }
  }
  rows->read_only(wanted);
  Collector all(path, name, found, trace);
  SkippedRows skipped;
  skipped.unit = rows->unit();
  for (std::vector<double> row; rows->next(row, skipped);) all.take(row);
  if (skipped.total() > 0)
    say(fmt::format("{}: {} rows could not be read; {}", path, skipped.total(), skipped.first[0]));
  return all.finish();
}

}  // namespace tauext
