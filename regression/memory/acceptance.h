// SPDX-License-Identifier: Apache-2.0
/// @file
/// What is slower or less accurate on purpose: said before it is merged, and for that merge alone.
#pragma once

#include <string>
#include <vector>

namespace tauext::gate {

/// The layers of findings that can be accepted.
inline constexpr const char *kTimeLayer = "time", *kLongLayer = "long",
                            *kInstructionsLayer = "instructions", *kCommittedLayer = "committed",
                            *kAccuracyLayer = "accuracy";

/// One finding that is meant.
struct Acceptance {
  std::string layer;    ///< one of those
  std::string subject;  ///< a kernel, or an entry and a metric
  double at_most = 0;   ///< [1] by how much it is worse; more than that is not accepted
  std::string base;     ///< the commit that it is worse than
  std::string reason;   ///< one line

  /// Whether it is about that finding, and large enough for it.
  bool covers(const std::string& its_layer, const std::string& its_subject, double by) const;
};

/// @throws std::runtime_error naming `where` and the field that is wrong
void check_acceptance(const Acceptance& a, const std::string& where);

/// Path of the acceptances in a folder of baselines.
std::string accepted_path(const std::string& folder);

/// Of a file that need not be there.
/// @throws std::runtime_error naming path and line: no such file, cut off, no number
std::vector<Acceptance> read_acceptances(const std::string& path);

/// The file's text: a line each, sorted.
std::string format_acceptances(std::vector<Acceptance> all);

}  // namespace tauext::gate
