// SPDX-License-Identifier: Apache-2.0
/// @file
/// Truth and estimates of entries, small enough for a page, with every peak. Not installed.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "bench/score/suite.h"

namespace tauext::report {

/// Times at which a group's signals are shown.
inline constexpr int kBuckets = 400;

/// Signals of one unit.
using Signals = std::vector<Eigen::VectorXd>;

/// Where n samples are cut into buckets: begins of buckets, and n. The bucket in which some signal
/// changes most, as a share of its range, is halved until there are `buckets` of them or each holds
/// one sample; so a step is resolved to the sample, and rest costs nothing. A range is taken for at
/// least a thousandth of the largest one of its unit, so that rounding noise is rest.
/// @param of_units n numbers each
std::vector<int> bucket_edges(const std::vector<Signals>& of_units, int buckets = kBuckets);

/// The first and the second extreme of each bucket, in the order in which they come, as 16-bit
/// shares of the signal's range.
struct Drawn {
  double low = 0, high = 0;           ///< [N m] the range: what 0 and 65535 stand for
  std::vector<std::uint16_t> values;  ///< two a bucket
};

/// A signal in these buckets. What is not finite is shown as 0.
Drawn draw(const Eigen::VectorXd& signal, const std::vector<int>& edges);

/// Entries one after the other, as "tauext-traces-1" (bench/report/README.md).
class Traces {
 public:
  /// @param site where forces are looked for; "": nowhere
  explicit Traces(std::string site = "") : site_(std::move(site)) {}
  /// Those of a group come together.
  /// @param forces what makes a force, and with 6 joints or more a moment, of each tau_ext, to be
  ///   shown beside it; nullptr: none
  void add(const Entry& entry, const Suite::Run& run, const ArmForces* forces = nullptr);
  /// @param run as of provenance()
  std::string json(const std::string& run);

 private:
  struct Series {
    std::string name;
    Eigen::MatrixXd tau_ext;  // a row each joint
    Eigen::MatrixXd wrench;   // 0, 3 or 6 rows
  };
  struct Marks {
    std::string name;
    std::vector<double> t;
  };
  void close();  // writes the group

  std::string site_, group_, groups_;
  std::vector<double> t_;
  std::vector<std::uint8_t> contact_;
  std::vector<Series> series_;
  std::vector<Marks> marks_;
};

}  // namespace tauext::report
