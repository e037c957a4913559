// SPDX-License-Identifier: Apache-2.0
/// @file
/// Runs and logs in Python.
#pragma once

#include <pybind11/pybind11.h>

namespace tauext::python {

void bind_runs(pybind11::module_& m);  ///< Run, read_log

}  // namespace tauext::python
