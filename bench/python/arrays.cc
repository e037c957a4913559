// SPDX-License-Identifier: Apache-2.0
#include "bench/python/arrays.h"

#include <fmt/format.h>

#include <stdexcept>

namespace tauext::python {

Eigen::MatrixXd columns(const Array& rows, pybind11::ssize_t samples, pybind11::ssize_t joints,
                        const char* what) {
  if (rows.ndim() != 2 || rows.shape(0) != samples || rows.shape(1) != joints)
    throw std::invalid_argument(
        fmt::format("{} has a row for each of {} samples, and a column for each of {} joints", what,
                    samples, joints));
  return Eigen::Map<const Eigen::MatrixXd>(rows.data(), joints, samples);
}

}  // namespace tauext::python
