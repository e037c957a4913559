// SPDX-License-Identifier: Apache-2.0
/// @file
/// How numbers go between Python and C++.
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <Eigen/Core>

namespace tauext::python {

/// Numbers of Python, row after row.
using Array = pybind11::array_t<double, pybind11::array::c_style | pybind11::array::forcecast>;

/// What a function of tauext/_arrays.py makes of arguments: there these become arrays.
template <class... A>
pybind11::object arrays(const char* function, const A&... arguments) {
  return pybind11::module_::import("tauext._arrays").attr(function)(arguments...);
}

/// A matrix with a column for each sample as an array with a row for each: a copy.
inline Array rows(const Eigen::MatrixXd& columns) {
  return Array({columns.cols(), columns.rows()}, columns.data());
}
/// The other way, of what `arrays` gave.
Eigen::MatrixXd columns(const pybind11::object& rows);
/// A number for each joint, by `arrays` unless it is such an array: estimators in Python are quick.
/// @param names of the joints, if they are known, by which pandas' are found
Eigen::VectorXd vector(const pybind11::object& x, const char* what, int joints,
                       const pybind11::object& names = pybind11::tuple());

}  // namespace tauext::python
