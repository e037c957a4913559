// SPDX-License-Identifier: Apache-2.0
#include "bench/python/arrays.h"

namespace tauext::python {

namespace py = pybind11;

namespace {

// of float64 and of this length; no class that is derived from numpy.ndarray, as masked ones are
bool is_plain(const py::object& x, int joints) {
  static const PyTypeObject* const ndarray = Py_TYPE(Array().ptr());
  if (Py_TYPE(x.ptr()) != ndarray || !py::isinstance<py::array_t<double, 0>>(x)) return false;
  const auto a = py::reinterpret_borrow<py::array>(x);
  return a.ndim() == 1 && a.shape(0) == joints;
}

}  // namespace

Eigen::MatrixXd columns(const py::object& rows) {
  const auto a = rows.cast<Array>();
  return Eigen::Map<const Eigen::MatrixXd>(a.data(), a.shape(1), a.shape(0));
}

Eigen::VectorXd vector(const py::object& x, const char* what, int joints, const py::object& names) {
  const Array a =
      (is_plain(x, joints) ? x : arrays("vector", x, what, joints, names)).cast<Array>();
  return Eigen::Map<const Eigen::VectorXd>(a.data(), joints);
}

}  // namespace tauext::python
