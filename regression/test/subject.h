// SPDX-License-Identifier: Apache-2.0
// An estimator that can be made worse in known ways, to see what the gate says.
#pragma once

#include <string>

#include "estimators/ndob.h"
#include "estimators/testbed1.h"

namespace tauext::gate::test {

/// The testbed's NDOB with a fault: "" none, "gain=1.01" its X times that, "delay" an estimate one
/// sample old, "sign" the other sign.
class Subject {
 public:
  static constexpr const char* kName = "subject";
  static constexpr int kDof = 1;

  Subject(const Testbed1& arm, const std::string& fault)
      : ndob_(arm, parameters(fault)), delay_(fault == "delay"), sign_(fault == "sign" ? -1 : 1) {}

  void reset() noexcept {
    ndob_.reset();
    last_ = {};
  }

  Estimate<1> update(const Measurement<1>& y) noexcept {
    Estimate<1> now = ndob_.update(y);
    now.tau_ext *= sign_;
    const Estimate<1> out = delay_ ? Estimate<1>{last_.tau_ext, now.status} : now;
    last_ = now;
    return out;
  }

 private:
  static Ndob<Testbed1>::Parameters parameters(const std::string& fault) {
    const double gain = fault.starts_with("gain=") ? std::stod(fault.substr(5)) : 1;
    return {.X = Vec<1>(gain * 30 * Testbed1::Parameters().theta1)};
  }

  Ndob<Testbed1> ndob_;
  bool delay_;
  double sign_;
  Estimate<1> last_;
};

}  // namespace tauext::gate::test
