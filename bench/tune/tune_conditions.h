// SPDX-License-Identifier: Apache-2.0
/// @file
/// What tauext-tune does with --conditions: it tunes the pairs of the study into a file.
#pragma once

#include <string>
#include <vector>

namespace tauext {

/// What its flags say.
struct ConditionsToTune {
  std::string robot;                    ///< "" for the first one that has runs
  std::vector<std::string> conditions;  ///< names
  std::string estimators, detectors;    ///< specifications, apart by commas; "" for all
  int evaluations;                      ///< of each pair
  std::string shard;                    ///< "I/N", or "" for all of it
  std::string out;                      ///< the file, to which is added
  std::string format;                   ///< of the table
};

/// Tunes the pairs that the file does not have, adds them, and prints them.
/// @returns an ExitCode: kInterrupted if there are pairs left
/// @throws as tune_study(), and std::runtime_error naming the file
int tune_conditions(const ConditionsToTune& what);

/// Puts files of tuned pairs together, in any order: the file that one machine makes.
/// @returns kGood
/// @throws std::runtime_error naming the file for what is none, and for a pair that is there twice
int merge_tuned(const std::vector<std::string>& paths, const std::string& out);

}  // namespace tauext
