// SPDX-License-Identifier: Apache-2.0
/// @file
/// Whether the estimates of a run can be used.
#pragma once

#include <cstdint>
#include <string>

#include "estimators/samples/status_counts.h"
#include "estimators/types.h"

namespace tauext {

/// Looks at the estimates of a run, one after the other: one that is not finite, diverged or met a
/// singular inertia spoils it, and so does a run of which most samples were left out.
class Soundness {
 public:
  Soundness() = default;
  /// Of a run whose statuses were counted: they need not be taken, only looked at.
  explicit Soundness(const StatusCounts& counts) : counts_(counts) {}

  /// One at t [s]. Those that are finite, kOk and about no joint need not be shown.
  void take(double t, Status status, std::uint8_t joints, bool is_finite) {
    counts_.add(status, joints);
    look(t, status, is_finite);
  }
  /// The same of one that was counted.
  void look(double t, Status status, bool is_finite);

  /// What is wrong with a run of so many samples; "" if nothing is.
  std::string why(std::int64_t samples) const;

 private:
  StatusCounts counts_;
  std::string why_;
};

}  // namespace tauext
