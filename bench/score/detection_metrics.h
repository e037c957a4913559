// SPDX-License-Identifier: Apache-2.0
/// @file
/// The metrics of marks and of what they are good for, each defined once.
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "bench/roster/pair.h"
#include "bench/score/score.h"
#include "estimators/samples/clock.h"
#include "mjcf/trace/trace.h"

namespace tauext {
namespace metrics {

/// [s] after a contact in which a mark, or another contact, still belongs to it.
inline constexpr double kGrace = 0.2;

/// Marks against the true contact. A collision begins with a contact. Contacts that follow each
/// other within kGrace are one collision: what was hit is still there, and an arm whose motor the
/// mark has stopped rebounds onto it. A collision is detected by the first mark from its begin
/// until kGrace after its last contact; any mark outside these windows is a false alarm, unless
/// somebody touches the arm on purpose, or did within kGrace before.
struct DetectionScore {
  int collisions = 0;          ///< that the truth has
  int detected = 0;            ///< of these
  std::vector<double> delays;  ///< [s] of these
  int false_alarms = 0;        ///< marks outside of them
  int intended = 0;            ///< touches on purpose
  int intended_marked = 0;     ///< of these, those in which something was marked
  double delay = 0;            ///< [s] largest delay of a detected collision; NaN without one
  /// [s] the steps by which a Clock goes on: what lies in a gap, nobody saw; without touches on
  /// purpose
  double watched = 0;
  double false_alarms_per_hour = 0;  ///< [1/h] of this time
};

/// The same score, of samples that come one by one.
class DetectionCounter {
 public:
  /// The next one, at t [s]: the label of a contact (Trace::contact), and whether it is marked.
  void take(double t, std::uint8_t contact, bool mark);
  DetectionScore score() const;  ///< of those that were taken

 private:
  void watch(double t, bool counts);
  bool take_intended(double t, bool touched, bool mark);

  DetectionScore s_;
  Clock clock_{std::numeric_limits<double>::infinity()};
  std::int64_t steps_ = 0;  // of this clock
  double before_ = 0;       // [s] watched before it started
  bool in_collision_ = false, touched_ = false, marked_ = false;
  double begin_ = 0, last_ = 0;  // [s] of the collision: its first and last contact
  // [s] of the touch on purpose; whether it goes on, and was marked
  double last_intended_ = -std::numeric_limits<double>::infinity();
  bool in_intended_ = false, intended_marked_ = false;
};

/// The score of these marks; all three are as long as t [s].
DetectionScore detection_score(const std::vector<double>& t,
                               const std::vector<std::uint8_t>& contact,
                               const std::vector<std::uint8_t>& marks);

/// [rad] how far an arm moves on, in the direction in which it moved, after a mark stopped its
/// motor at sample trace.stopped_at: the largest of its joints. NaN if nothing stopped it.
double overtravel(const Trace& trace);

/// [N] the largest force of a contact; 0 without a sample.
double peak(const std::vector<double>& force);

/// An interval.
struct Interval {
  double low = 0;   ///< in the unit of what it is of
  double high = 0;  ///< likewise
};

/// The share of which `found` of `all` leave 95 % likely (Wilson 1927); 0 to 1 for none.
Interval share_interval(int found, int all);

/// The mean number of events of which `count` leave 95 % likely (Garwood 1936).
Interval count_interval(int count);

/// Smallest of the values that at least `share` of them do not exceed; NaN without a value.
double quantile(std::vector<double> values, double share);

/// The rate that can be excluded at 95 % if `count` events were seen: with a mean of
/// poisson_upper(count) so few or fewer are seen in 5 % of all trials (Garwood 1936). 3.0 for none.
double poisson_upper(int count);

}  // namespace metrics

/// The trace's contacts against the output's marks; nothing without a detector or without known
/// contacts.
void add_detection_metrics(const Trace& trace, const Output& output, Score& score);

/// What the detector said of the samples, whether it marked or not; nothing without a sample.
void add_score_metrics(const std::vector<Detection>& detections, Score& score);

/// What stopping at the mark was worth: overtravel, and the contact's peak force with and without.
void add_reaction_metrics(const Trace& stopped, const Trace& free, Score& score);

}  // namespace tauext
