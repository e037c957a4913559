// SPDX-License-Identifier: Apache-2.0
/// @file
/// What an entry was worth.
#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "bench/score/metric_list.h"
#include "estimators/samples/status_counts.h"

namespace tauext {

/// The value of a metric that has none ("never").
inline constexpr double kNoValue = std::numeric_limits<double>::quiet_NaN();

/// A value for each metric that exists for the run, NaN where it has no value ("never settles"),
/// and the values of the joints where the metric is judged joint by joint.
class Score {
 public:
  std::string error;    ///< why the entry failed; "" if it did not
  StatusCounts counts;  ///< of the samples that were scored, by reason and joint
  int collisions = 0;   ///< of which the recall is a share

  /// Nothing for a metric that does not exist for the run.
  std::optional<double> get(Metric m) const { return values_[index(m)]; }

  /// A value for each joint, from 0; none for a joint of which the run asks nothing.
  using Joints = std::vector<std::optional<double>>;

  /// Empty unless the metric exists and is judged joint by joint.
  const Joints& joints(Metric m) const { return joints_[index(m)]; }

  /// @throws std::out_of_range or std::bad_optional_access for a joint that has no value
  double joint(Metric m, int j) const { return joints(m).at(static_cast<std::size_t>(j)).value(); }

  /// Whether nothing was scored yet.
  bool empty() const;

  void set(Metric m, double value) { values_[index(m)] = value; }  ///< NaN for "never"

  void unset(Metric m) { values_[index(m)].reset(); }  ///< as if it did not exist for the run

  /// Sets the joints' values and that of the worst of them, if there is any.
  void set_joints(Metric m, Joints values);

  /// Every value by its key, those of joints after that of the entry; behind them the samples left
  /// out, by reason and joint.
  std::vector<std::pair<std::string, double>> by_key() const;

 private:
  static constexpr std::size_t index(Metric m) { return static_cast<std::size_t>(m); }

  std::array<std::optional<double>, kMetricCount> values_;
  std::array<Joints, kMetricCount> joints_;
};

}  // namespace tauext
