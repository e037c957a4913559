// SPDX-License-Identifier: Apache-2.0
/// @file
/// What studies keep of a detector's answers.
#pragma once

#include <vector>

#include "estimators/types.h"

namespace tauext {

/// What a detector made of one run, from a time on.
struct Answers {
  /// A fiducial mark.
  struct Mark {
    double t;         ///< [s]
    Contact contact;  ///< what for
  };
  /// [s] from one rise through a level to the next, at least
  static constexpr double kApart = 0.2;

  std::vector<Mark> marks;                 ///< all there are
  std::vector<std::vector<double>> rises;  ///< [s] where the score rose through each level
  long samples = 0;                        ///< that were looked at
  long alarmed = 0;                        ///< of them, with a score of 1 or more
};

}  // namespace tauext
