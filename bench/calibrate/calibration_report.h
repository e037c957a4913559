// SPDX-License-Identifier: Apache-2.0
/// @file
/// What a calibration says, as tables for people.
#pragma once

#include <string>
#include <vector>

#include "bench/calibrate/arm_calibration.h"
#include "bench/calibrate/identify.h"
#include "bench/calibrate/weighing.h"
#include "mjcf/trace/table_writer.h"

namespace tauext {

/// The parameters of each joint with their errors.
std::string parameter_table(const std::vector<CalibratedJoint>& joints, TableFormat format);

/// How well they explain the recordings; and in sentences what may be missing, and what nobody can
/// see.
std::string fit_report(const std::vector<CalibratedJoint>& joints);

/// A weight seen with the payload, without it, and their difference.
std::string weighing_table(const Weighing& w, TableFormat format);

/// The parameters of a one-joint model, and what its residuals say.
std::string identification_report(const std::vector<Term>& terms, const Identification& id);

/// The parameters alone.
std::string identification_csv(const std::vector<Term>& terms, const Identification& id);

}  // namespace tauext
