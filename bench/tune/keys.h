// SPDX-License-Identifier: Apache-2.0
/// @file
/// Which numbers of an estimator and of the detector behind it are tuned.
#pragma once

#include <string>
#include <vector>

#include "bench/roster/specification.h"

namespace tauext {

/// A number to be found: of the estimator or of the detector. One of each joint is multiplied by
/// one factor, so that joints keep their proportions.
struct TunedKey {
  std::string key;            ///< as a specification has it
  double low = 0, high = 0;   ///< [unit] between which it is; of joints, the largest one's
  bool of_detector = false;   ///< else of the estimator
  std::vector<double> start;  ///< [unit] one, or one for each joint
  bool whole = false;         ///< whether it is a whole number

  double largest_start() const;  ///< [unit] of `start`, which is not empty
};

/// A pair of specifications, without the keys that are tuned.
struct TunedPair {
  std::string estimator, detector;  ///< "" for no detector
};

/// The keys by texts like "w" and "threshold=10:500": without a range a thirtieth to thirty times
/// the start, which is what the specification says, or else the key's default. With a range, and
/// a default of 0 or none, the start is the geometric mean of its ends.
/// @param of_estimator,of_detector the fields of the pair, as Robot has them
/// @throws std::invalid_argument for a key that neither has or both, a range that is none, and a
/// key without a known number to begin with
std::vector<TunedKey> keys_of(const std::vector<std::string>& texts, const TunedPair& pair,
                              const std::vector<FieldHelp>& of_estimator,
                              const std::vector<FieldHelp>& of_detector);

/// The pair without these keys.
TunedPair without(const TunedPair& pair, const std::vector<TunedKey>& keys);

}  // namespace tauext
