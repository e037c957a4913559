// SPDX-License-Identifier: Apache-2.0
/// @file
/// What became of all samples of a run.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <string>

#include "estimators/types.h"

namespace tauext {

/// How many samples had each status, and of which joints it was.
class StatusCounts {
 public:
  /// One more, with the joints of its Estimate.
  void add(Status s, std::uint8_t joints) noexcept {
    ++samples_;
    ++by_status_[index(s)];
    if (joints == 0) return;
    for (std::size_t j = 0; j < kJoints; ++j) by_joint_[index(s)][j] += joints >> j & 1;
  }

  /// All of another run, too, but for its first sample if that starts: one start is no news.
  void add(const StatusCounts& run) noexcept {
    const std::int64_t starts = of(Status::kStarted) > 0 && run.of(Status::kStarted) > 0 ? 1 : 0;
    samples_ += run.samples_ - starts;
    by_status_[index(Status::kStarted)] -= starts;
    for (std::size_t s = 0; s < kStatuses; ++s) {
      by_status_[s] += run.by_status_[s];
      for (std::size_t j = 0; j < kJoints; ++j) by_joint_[s][j] += run.by_joint_[s][j];
    }
  }

  std::int64_t samples() const noexcept { return samples_; }                 ///< all
  std::int64_t of(Status s) const noexcept { return by_status_[index(s)]; }  ///< of this status
  /// Of this status and joint, from 0; one sample may be about several.
  std::int64_t of(Status s, int joint) const noexcept {
    return by_joint_[index(s)][static_cast<std::size_t>(joint)];
  }

  /// All that made no estimate, but for the first one, which starts.
  std::int64_t left_out() const noexcept {
    const std::int64_t first = of(Status::kStarted) > 0 ? 1 : 0;
    return samples_ - of(Status::kOk) - first;
  }

  /// Calls visit("left_out_bad_time", 12) and the like for each reason, and for each of its joints
  /// ("left_out_frozen_2"; "put_right_2").
  template <class Visit>
  void for_each(Visit&& visit) const {
    for (std::size_t s = 0; s < kStatuses; ++s) {
      if (s == index(Status::kStarted) || by_status_[s] == 0) continue;
      std::string key =
          s == 0 ? "put_right" : std::string("left_out_") + name_of(static_cast<Status>(s));
      std::replace(key.begin(), key.end(), ' ', '_');
      if (s > 0) visit(key, by_status_[s]);
      for (std::size_t j = 0; j < kJoints; ++j) {
        if (by_joint_[s][j] > 0) visit(key + "_" + std::to_string(j + 1), by_joint_[s][j]);
      }
    }
  }

  /// Like "left out: 12 bad time, 3 frozen (joint 2: 3)"; "" if there is nothing to say.
  std::string sentence() const { return (left_out() > 0 ? "left out: " : "") + text(); }

  /// The reasons alone.
  std::string text() const {
    std::string out;
    for (std::size_t k = 1; k <= kStatuses; ++k) {
      const std::size_t s = k % kStatuses;  // what was put right comes last
      const auto status = static_cast<Status>(s);
      const std::int64_t n = of(status) - (status == Status::kStarted ? 1 : 0);
      if (n <= 0) continue;
      std::string joints;
      for (std::size_t j = 0; j < kJoints; ++j) {
        if (by_joint_[s][j] == 0) continue;
        joints += (joints.empty() ? " (joint " : ", ") + std::to_string(j + 1) + ": " +
                  std::to_string(by_joint_[s][j]);
      }
      if (!joints.empty()) joints += ")";
      if (status == Status::kOk && joints.empty()) continue;
      if (!out.empty()) out += ", ";
      if (status == Status::kOk) {
        out += "put right" + joints;
      } else {
        out += std::to_string(n) + " " +
               (status == Status::kStarted ? "started again" : name_of(status)) + joints;
      }
    }
    return out;
  }

 private:
  static constexpr std::size_t kStatuses = kStatusCount, kJoints = 8;
  static std::size_t index(Status s) noexcept { return static_cast<std::size_t>(s); }

  std::int64_t samples_ = 0;
  std::array<std::int64_t, kStatuses> by_status_{};
  std::array<std::array<std::int64_t, kJoints>, kStatuses> by_joint_{};
};

}  // namespace tauext
