// SPDX-License-Identifier: Apache-2.0
/// @file
/// An estimator that is written in Python, beside those of the roster: the specification
/// `python:maker=N` runs it wherever an estimator is asked for. Who asks must not hold the
/// interpreter's lock, as every update takes it.
#pragma once

#include <pybind11/pybind11.h>

#include <limits>
#include <memory>
#include <string>
#include <tuple>

#include "bench/python/arm.h"
#include "estimators/concepts.h"
#include "estimators/parameters.h"

namespace tauext::python {

/// Keeps what makes estimators, a callable of an Arm, and gives the specification of these.
std::string add_maker(pybind11::object make);

/// Throws what an estimator in Python threw since the last call, the first of several.
void rethrow();

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

/// Lists `python` among the estimators of every robot, once and before these are first asked for.
void register_estimators();

/// One object in Python, made by such a callable.
class Object {
 public:
  /// @param arm as estimators know it, for the callable
  /// @throws std::invalid_argument for a number that add_maker() never gave
  Object(double maker, std::shared_ptr<Arm> arm);
  /// Makes another one.
  void reset() noexcept;
  /// Calls update(t, q, qd, tau) with n joints.
  /// @returns false where that throws or gives no n numbers: rethrow() says what
  bool update(double t, int n, const double* q, const double* qd, const double* tau,
              double* tau_ext) noexcept;

 private:
  struct Locked;  // the object, which is destroyed under the lock
  std::shared_ptr<Locked> it_;
};

/// The estimator of such an object.
template <RobotModel M>
class PythonEstimator {
 public:
  static constexpr const char* kName = "python";
  static constexpr int kDof = M::kDof;

  struct Parameters {
    double maker = 0;  ///< [1] of add_maker()

    static constexpr auto fields() {
      return std::tuple(Field{"maker", &Parameters::maker, "1", 0, 1e9, "which one in Python"});
    }
  };

  /// @throws std::invalid_argument as Object does
  PythonEstimator(const M& arm, const Parameters& p)
      : object_(p.maker, std::make_shared<ArmOf<M>>(arm)) {}

  void reset() noexcept { object_.reset(); }

  /// kDiverged, and no number, from the first sample on that Python does not answer.
  Estimate<kDof> update(const Measurement<kDof>& y) noexcept {
    Estimate<kDof> e;
    if (object_.update(y.t, kDof, y.q.data(), y.qd.data(), y.tau.data(), e.tau_ext.data()))
      return e;
    e.tau_ext.setConstant(std::numeric_limits<double>::quiet_NaN());
    e.status = Status::kDiverged;
    return e;
  }

 private:
  Object object_;
};

}  // namespace tauext::python
