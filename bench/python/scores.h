// SPDX-License-Identifier: Apache-2.0
/// @file
/// What estimates are worth, in Python.
#pragma once

#include <pybind11/pybind11.h>

namespace tauext::python {

void bind_scores(pybind11::module_& m);  ///< metrics, score, suite, study, estimator

}  // namespace tauext::python
