// SPDX-License-Identifier: Apache-2.0
/// @file
/// How numbers go between Python and C++, and who waits for whom.
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "bench/python/python_estimator.h"

namespace tauext::python {

/// Numbers of Python, row after row.
using Array = pybind11::array_t<double, pybind11::array::c_style | pybind11::array::forcecast>;

/// A matrix with a column for each sample as an array with a row for each: a copy.
inline Array rows(const Eigen::MatrixXd& columns) {
  return Array({columns.cols(), columns.rows()}, columns.data());
}
/// The other way.
/// @throws std::invalid_argument naming what is of another shape
Eigen::MatrixXd columns(const Array& rows, pybind11::ssize_t samples, pybind11::ssize_t joints,
                        const char* what);

/// work() without the interpreter's lock; then throws what an estimator in Python threw meanwhile.
template <class Work>
auto unlocked(const Work& work) {
  const auto answer = [&] {
    const pybind11::gil_scoped_release free;
    return work();
  }();
  rethrow();
  return answer;
}

}  // namespace tauext::python
