// SPDX-License-Identifier: Apache-2.0
/// @file
/// THE list of metrics. Tables, legends, JSON, golden files, tauext-gate, summaries and
/// bench/score/README.md read it; a metric's key is spelled here alone. A new metric is a row here,
/// a definition and a call beside it (metrics.h or detection_metrics.h).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace tauext {

/// One for each row of the list, in its order.
enum class Metric : std::uint8_t {
  kRmse,
  kBias,
  kMax,
  kMaxAt,
  kForce,
  kNoise,
  kRise,
  kRise0To90,
  kSettling,
  kOvershoot,
  kFinal,
  kLag,
  kBandwidth,
  kFloor,
  kDrift,
  kMakerCorrelation,
  kMakerGain,
  kMakerLag,
  kDelay,
  kDelayMedian,
  kRecall,
  kRecallLow,
  kRecallHigh,
  kFalseAlarms,
  kFalseAlarmsPerHour,
  kFalseAlarmsLow,
  kFalseAlarmsHigh,
  kPeakScore,
  kMeanScore,
  kContactShare,
  kOvertravel,
  kPeak,
  kPeakUnstopped,
  kCpu,
  kAllocs,
  kLeftOut,
  kFailed,
};

/// Which values are good.
enum class Better : std::uint8_t { kLess, kMore, kNeither };

/// Whether a metric is judged joint by joint, and which joint then stands for the entry. A joint
/// without a value ("never") is worse than all others.
enum class WorstJoint : std::uint8_t { kNone, kLargest, kSmallest };

/// What is to be known of a metric.
struct MetricRow {
  /// Who reads it, and how.
  enum Use : unsigned {
    kTable = 1,  ///< the suite's table has a column for it
    kStar = 2,   ///< the table marks the best value; else the value is a choice
    kGate = 4,   ///< golden files hold it, for tauext-gate
    kUsual = kTable | kStar | kGate,
    kZeroIsNoMerit = 8,    ///< an exact 0 does not compete
    kNeverIsBest = 16,     ///< no value ("never") is the best value; else it is the worst
    kOneSeedIsWorse = 32,  ///< tauext-gate needs no more than one seed
    kGateJoints = 64,      ///< golden files hold each joint's, too
  };

  Metric metric = {};                     ///< whose row it is
  std::string_view key;                   ///< QUANTITY_UNIT, in every file and message
  std::string_view title;                 ///< of the table's column
  std::string_view unit;                  ///< as it is printed; "" for a mere number
  int digits = 0;                         ///< after the point
  Better better = Better::kLess;          ///< which way is better
  WorstJoint joints = WorstJoint::kNone;  ///< whether it is judged joint by joint
  unsigned uses = 0;                      ///< of Use
  std::string_view meaning;               ///< one sentence
  /// What may change between two machines, absolute or relative, whichever is larger.
  double tolerance = 1e-9;

  constexpr bool is(Use use) const { return (uses & use) != 0; }  ///< whether it has that use
};

namespace detail {
using enum Metric;
using enum Better;
using enum WorstJoint;
using enum MetricRow::Use;
inline constexpr std::array kRowsOfEstimates{
    MetricRow{kRmse, "rmse_Nm", "rmse", "N m", 3, kLess, kLargest, kUsual | kGateJoints,
              "The root of the mean squared error of the estimate."},
    MetricRow{kBias, "bias_Nm", "bias", "N m", 3, kLess, kLargest, kGate,
              "The size of the mean error."},
    MetricRow{kMax, "max_Nm", "max", "N m", 2, kLess, kLargest, kUsual, "The largest error."},
    MetricRow{kMaxAt, "max_at_s", "max at", "s", 3, kNeither, kNone, kGate,
              "The time of the largest error."},
    MetricRow{kForce, "force_rmse_N", "force", "N", 3, kLess, kNone, kUsual,
              "The root of the mean squared error of the force at the end effector."},
    MetricRow{kNoise, "noise_Nm", "noise", "N m", 3, kLess, kLargest, kUsual | kZeroIsNoMerit,
              "The standard deviation of what sensor noise adds to the estimate."},
    MetricRow{kRise, "rise_s", "rise", "s", 3, kLess, kLargest, kUsual,
              "The time from 10 % to 90 % of a step of the load."},
    MetricRow{kRise0To90, "rise_0_90_s", "rise 0-90 %", "s", 3, kLess, kLargest, kGate,
              "The time from the step of the load until the estimate has 90 % of it."},
    MetricRow{kSettling, "settling_s", "settling", "s", 3, kLess, kLargest, kUsual,
              "The time from the step until the estimate, noise included, stays within 2 % of it."},
    MetricRow{kOvershoot, "overshoot_percent", "overshoot", "%", 1, kLess, kLargest, kUsual,
              "How far the estimate goes beyond the step, as a share of the step."},
    MetricRow{kFinal, "final_Nm", "final", "N m", 3, kLess, kLargest, kUsual,
              "The size of the mean error over the last second."},
    MetricRow{kLag, "lag_s", "lag", "s", 3, kLess, kLargest, kUsual,
              "The delay of the estimate behind a load that changes all the time."},
    MetricRow{kBandwidth, "bandwidth_rad_s", "bandwidth", "rad/s", 1, kMore, kSmallest,
              kTable | kGate | kNeverIsBest,
              "The frequency at which the estimate falls to 71 % (-3 dB) of the load."},
    MetricRow{kFloor, "floor_Nm", "floor", "N m", 3, kLess, kLargest, kTable | kStar,
              "Of a log: the root mean square of the estimate while nothing touches."},
    MetricRow{kDrift, "drift_Nm", "drift", "N m", 3, kLess, kLargest, kTable | kStar,
              "Of a log: how much the estimate's mean differs between its first and last third."},
    MetricRow{kMakerCorrelation, "maker_correlation", "maker's", "corr.", 3, kMore, kSmallest,
              kTable,
              "The correlation of the estimate with that of the robot's maker, or of a sensor."},
    MetricRow{kMakerGain, "maker_gain", "maker's", "gain", 3, kNeither, kNone, kTable,
              "By what the estimate has to be multiplied to be closest to that of the maker."},
    MetricRow{kMakerLag, "maker_lag_s", "maker's", "lag s", 3, kNeither, kNone, kTable,
              "How much the estimate comes after that of the maker; negative: before it."},
};

inline constexpr std::array kRowsOfMarks{
    MetricRow{kDelay, "delay_s", "delay", "s", 3, kLess, kNone, kUsual,
              "The longest time from the first contact of a collision to its mark."},
    MetricRow{kDelayMedian, "delay_median_s", "median", "s", 3, kLess, kNone, kTable | kStar,
              "The median of these times, over the labelled contacts of logs."},
    MetricRow{kRecall, "recall", "recall", "", 2, kMore, kNone, kGate,
              "The share of the collisions that were marked."},
    MetricRow{kRecallLow, "recall_low", "recall", "at least", 2, kMore, kNone, kTable,
              "The least share that the labelled contacts of logs leave likely (Wilson, 95 %)."},
    MetricRow{kRecallHigh, "recall_high", "recall", "at most", 2, kMore, kNone, kTable,
              "The largest such share."},
    MetricRow{kFalseAlarms, "false_alarms", "false", "alarms", 0, kLess, kNone, kUsual,
              "The number of marks that belong to no collision."},
    MetricRow{kFalseAlarmsPerHour, "false_alarms_per_hour", "false alarms", "1/h", 1, kLess, kNone,
              0, "The number of marks in an hour, gaps left aside, that belong to no collision."},
    MetricRow{kFalseAlarmsLow, "false_alarms_per_hour_low", "false from", "1/h", 1, kLess, kNone,
              kTable, "The least number in an hour that logs leave likely (Garwood, 95 %)."},
    MetricRow{kFalseAlarmsHigh, "false_alarms_per_hour_high", "false to", "1/h", 1, kLess, kNone,
              kTable, "The largest such number."},
    MetricRow{kPeakScore, "peak_score", "peak score", "", 2, kNeither, kNone, kGate,
              "The largest score of the detector, which marks from 1 on."},
    MetricRow{kMeanScore, "mean_score", "mean score", "", 3, kNeither, kNone, kGate,
              "The mean score of the detector, in which every threshold shows."},
    MetricRow{kContactShare, "contact_share", "contact", "", 3, kNeither, kNone, kGate,
              "The share of the samples for which the detector says that something touches."},
    MetricRow{kOvertravel, "overtravel_rad", "overtravel", "rad", 4, kLess, kNone, kUsual,
              "How far the arm moves on after the mark has stopped its motor."},
    MetricRow{kPeak, "peak_N", "peak", "N", 0, kLess, kNone, kUsual,
              "The largest force of the contact when the mark stops the motor."},
    MetricRow{kPeakUnstopped, "peak_unstopped_N", "unstopped", "N", 0, kLess, kNone, kUsual,
              "The largest force of the same contact when nothing stops the motor."},
    MetricRow{kCpu, "cpu_ns", "step", "ns", 1, kLess, kNone, kTable | kStar,
              "The CPU time of one step of estimator and detector."},
    MetricRow{kAllocs, "allocs", "allocs", "1/step", 0, kLess, kNone, kUsual,
              "The number of memory allocations in one step."},
    MetricRow{kLeftOut, "left_out", "left out", "samples", 0, kLess, kNone, kGate,
              "The number of samples that the estimator could not use."},
    MetricRow{kFailed, "failed", "failed", "", 0, kLess, kNone, kGate | kOneSeedIsWorse,
              "1 for an entry that failed, else 0."},
};

template <std::size_t N, std::size_t M>
constexpr auto together(const std::array<MetricRow, N>& a, const std::array<MetricRow, M>& b) {
  std::array<MetricRow, N + M> all;
  for (std::size_t i = 0; i < N; ++i) all[i] = a[i];
  for (std::size_t i = 0; i < M; ++i) all[N + i] = b[i];
  return all;
}
}  // namespace detail

/// The list.
inline constexpr auto kMetrics = detail::together(detail::kRowsOfEstimates, detail::kRowsOfMarks);

/// Where something stands in the arm's way, so many times the tolerance.
inline constexpr double kOfContacts = 1000;

inline constexpr std::size_t kMetricCount = kMetrics.size();  ///< rows

/// The row of a metric.
constexpr const MetricRow& row_of(Metric m) {
  return kMetrics[static_cast<std::size_t>(m)];
}

/// The row of a key; nullptr for a key that is none of ours.
constexpr const MetricRow* find_metric(std::string_view key) {
  for (const MetricRow& m : kMetrics) {
    if (m.key == key) return &m;
  }
  return nullptr;
}

/// The title of a metric's column.
inline std::string title_of(Metric m) {
  return std::string(row_of(m).title);
}
/// Its key.
inline std::string key_of(Metric m) {
  return std::string(row_of(m).key);
}

/// The key of one joint, which count from 1: "rmse_Nm_joint2".
inline std::string key_of(Metric m, int joint) {
  return key_of(m) + "_joint" + std::to_string(joint);
}

static_assert(
    [] {
      for (std::size_t i = 0; i < kMetricCount; ++i) {
        if (static_cast<std::size_t>(kMetrics[i].metric) != i) return false;
        if (find_metric(kMetrics[i].key) != &kMetrics[i]) return false;
      }
      return kMetricCount == static_cast<std::size_t>(Metric::kFailed) + 1;
    }(),
    "a row for each metric, in the order of the enumerators, and no key twice");

}  // namespace tauext
