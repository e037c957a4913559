// SPDX-License-Identifier: Apache-2.0
/// @file
/// Robots in Python, and what their estimators and detectors say.
#pragma once

#include <pybind11/pybind11.h>

namespace tauext::python {

void bind_robots(pybind11::module_& m);  ///< Robot, Arm, Estimates, Detections

}  // namespace tauext::python
