// SPDX-License-Identifier: Apache-2.0
/// @file
/// Robots in Python, and what their estimators and detectors say.
#pragma once

#include <pybind11/pybind11.h>

#include <cstdint>
#include <string>

#include "bench/score/degradation.h"

namespace tauext::python {

/// What is wrong with sensors, model and drives: the text of a JSON object, or what
/// read_degradation() takes; "" for nothing.
/// @param seed of the sensors
/// @throws as set_degradation() and read_degradation() do
Degradation degradation_of(const std::string& degrade, std::uint64_t seed);

void bind_robots(pybind11::module_& m);  ///< Robot, Arm, Estimates, Detections

}  // namespace tauext::python
