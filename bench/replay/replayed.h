// SPDX-License-Identifier: Apache-2.0
/// @file
/// What estimators made of a log: a file of their estimates, and what is said of them.
#pragma once

#include <cstdio>
#include <string>
#include <vector>

#include "bench/roster/robot.h"

namespace tauext {

/// What an estimate means: the force at a point, and the link that is touched.
struct Acting {
  SiteForce force;   ///< at the point
  TouchPlace touch;  ///< wherever it is
};

/// One estimator's run.
struct Replayed {
  std::string estimator;       ///< its specification
  std::string detector;        ///< behind it; "" for none
  Output output;               ///< what both said
  std::vector<Acting> acting;  ///< of each sample; empty if nobody asked
};

/// What the estimates of a trace mean, sample by sample.
std::vector<Acting> acting(const ArmForces& arm, const Trace& trace, const Output& output);

/// Writes a CSV with a row for each sample: t, and of each estimator its tau_ext, status, mark and
/// forces; or a .npz with the arrays t, NAME_tau_ext, NAME_status, the marks, and NAME_force,
/// NAME_moment and NAME_link. To standard output if the path is "-"; the file appears whole or not
/// at all.
/// @throws std::runtime_error naming the path
void write_estimates(const Trace& trace, const std::vector<Replayed>& all, const std::string& path);

/// A table of their errors, over samples with t >= score_from [s], if the trace has a truth; and
/// what their detectors were worth, if it has contacts.
void print_metrics(const Trace& trace, const std::vector<Replayed>& all, double score_from,
                   std::FILE* to);

/// Of each the largest force, if forces were looked for.
void print_forces(const Trace& trace, const std::vector<Replayed>& all, std::FILE* to);

}  // namespace tauext
