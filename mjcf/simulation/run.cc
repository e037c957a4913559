// SPDX-License-Identifier: Apache-2.0
#include "mjcf/simulation/run.h"

#include <fmt/format.h>

namespace tauext::detail {

Tracking tracking(const Scenario& s, const Recording& r) {
  if (!(r.Ts > 0 && r.Ts <= 0.1) || r.substeps < 1 || r.substeps > 1000) {
    throw std::invalid_argument(
        fmt::format("sampling time {} s with {} substeps: 0 < Ts <= 0.1 s and 1 to 1000 substeps",
                    r.Ts, r.substeps));
  }
  const Tracking c{r.Kp.value_or(s.tracking.Kp), r.Kd.value_or(s.tracking.Kd)};
  if (!(c.Kp >= 0 && c.Kp <= 1e6 && c.Kd >= 0 && c.Kd <= 1e4)) {
    throw std::invalid_argument(
        fmt::format("Kp = {} 1/s^2, Kd = {} 1/s: 0 to 1e6 and 0 to 1e4", c.Kp, c.Kd));
  }
  return c;
}

void check(const Drives& d, int joints, const Eigen::VectorXd& usual_torque) {
  const auto require = [](const char* name, double x, double least, double most) {
    if (x >= least && x <= most) return;
    throw std::invalid_argument(
        fmt::format("drives {} must be {:g} to {:g}, not {}", name, least, most, x));
  };
  if (!d.any())
    throw std::invalid_argument("drives: the others want stiffness, coulomb or viscous");
  require("stiffness [u/rad]", d.stiffness, 0, 1e6);
  require("rotor [u s^2/rad]", d.rotor, 1e-6, 10);
  require("damping [1]", d.damping, 0, 2);
  require("coulomb [u]", d.coulomb, 0, 10);
  require("stribeck [1]", d.stribeck, 0, 10);
  require("viscous [u s/rad]", d.viscous, 0, 10);
  require("drift [1]", d.drift, 0, 1);
  if (usual_torque.size() != joints || !(usual_torque.minCoeff() > 0))
    throw std::invalid_argument(
        "drives are in shares of what each joint is used to, and some joint of this arm is used to "
        "nothing");
}

void fail_limit(const Scenario& s, int joint, double t, double q, bool is_tied) {
  throw std::runtime_error(
      fmt::format("scenario {}: joint {} reaches its limit at t = {:g} s, at {:.4g} rad (or m); {}",
                  s.name, joint + 1, t, q,
                  is_tied ? "an arm whose joints follow others must not; --lock REGEX fixes these"
                          : "a scenario that means to sets reaches_limits"));
}

void fail_step(const Scenario& s, const Recording& r, const std::string& why) {
  const Tracking c = tracking(s, r);
  throw std::runtime_error(fmt::format(
      "scenario {}: {} Tracking may be too stiff for Ts = {} s: Kp = {} 1/s^2, Kd = {} 1/s", s.name,
      why, r.Ts, c.Kp, c.Kd));
}

}  // namespace tauext::detail
