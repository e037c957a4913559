// SPDX-License-Identifier: Apache-2.0
#include "bench/python/python_estimator.h"

#include <fmt/format.h>

#include <Eigen/Core>
#include <exception>
#include <mutex>
#include <stdexcept>
#include <utility>
#include <vector>

#include "bench/python/arrays.h"
#include "bench/registry.h"

namespace tauext::python {
namespace {

namespace py = pybind11;

// never destroyed: the interpreter may be gone before
std::vector<py::object>& makers() {
  static auto* const all = new std::vector<py::object>();
  return *all;
}

std::mutex mutex;
std::exception_ptr first_error;

void keep_error() {
  const std::lock_guard alone(mutex);
  if (!first_error) first_error = std::current_exception();
}

}  // namespace

struct Object::Locked {
  py::object make, object;
  std::shared_ptr<Arm> arm;
  ~Locked() {
    const py::gil_scoped_acquire lock;
    make = object = py::object();
  }
};

std::string add_maker(py::object make) {
  makers().push_back(std::move(make));
  return fmt::format("python:maker={}", makers().size());
}

void rethrow() {
  const std::lock_guard alone(mutex);
  if (first_error) std::rethrow_exception(std::exchange(first_error, nullptr));
}

Object::Object(double maker, std::shared_ptr<Arm> arm) {
  const py::gil_scoped_acquire lock;
  if (!(maker >= 1 && maker <= static_cast<double>(makers().size())))
    throw std::invalid_argument(
        "python: an estimator in Python is named by what tauext.estimator() returns");
  it_ = std::make_shared<Locked>();
  it_->make = makers()[static_cast<std::size_t>(maker) - 1];
  it_->arm = std::move(arm);
  it_->object = it_->make(it_->arm);
}

void Object::reset() noexcept {
  const py::gil_scoped_acquire lock;
  try {
    it_->object = it_->make(it_->arm);
  } catch (...) {
    keep_error();
    it_->object = py::none();
  }
}

bool Object::update(double t, int n, const double* q, const double* qd, const double* tau,
                    double* tau_ext) noexcept {
  const py::gil_scoped_acquire lock;
  if (it_->object.is_none()) return false;
  try {
    const py::object answer =
        it_->object.attr("update")(t, Array(n, q), Array(n, qd), Array(n, tau));
    Eigen::Map<Eigen::VectorXd>(tau_ext, n) = vector(answer, "what update() returns", n);
    return true;
  } catch (...) {
    keep_error();
    it_->object = py::none();
    return false;
  }
}

void register_estimators() {
  const auto make = [](const auto& arm) {
    using E = PythonEstimator<std::decay_t<decltype(arm)>>;
    return E(arm, typename E::Parameters());
  };
  register_estimator<WallMoBot3>(make);
  register_estimator<Testbed1>(make);
  register_file_estimator(make);
}

}  // namespace tauext::python
