// SPDX-License-Identifier: Apache-2.0
#include "mjcf/arm_forces.h"

#include <fmt/format.h>

#include <optional>
#include <stdexcept>

#include "mjcf/plant/any_tree.h"

namespace tauext {
namespace {

// Arms of fewer joints have the rest without a body: they carry nothing, and compile once.
using Arm = TiedTree;
using Numbers = Vec<kMostCoordinates>;  // one of each coordinate

class Forces final : public ArmForces {
 public:
  Forces(const ArmTree& tree, const ArmForceOptions& o)
      : joints_(tree.dof()),
        arm_(detail::filled<Arm>(tree)),
        at_(tree.point(o.site)),
        force_(arm_, at_, {.moment = o.moment}) {
    if (o.moment && joints_ < kJointsOfMoment)
      throw std::invalid_argument("force and moment at a point want 6 joints or more");
    if (o.limits.size() == 0) return;
    Numbers limits = Numbers::Ones();
    limits.head(joints_) = o.limits;
    touch_.emplace(arm_, limits);
  }

  SiteForce at_site(const double* q, const double* tau_ext) const noexcept override {
    return force_(wide(q), wide(tau_ext));
  }
  TouchPlace touch(const double* q, const double* tau_ext) const noexcept override {
    return touch_ ? (*touch_)(wide(q), wide(tau_ext)) : TouchPlace();
  }
  Eigen::VectorXd torque(const Eigen::VectorXd& q, const Vec<3>& f) const override {
    const auto J = arm_.jacobian(wide(q.data()), at_.joint, at_.place);
    return -(J.topRows<3>().transpose() * f).head(joints_);
  }

 private:
  Numbers wide(const double* v) const noexcept {
    Numbers out = Numbers::Zero();
    for (Eigen::Index i = 0; i < joints_; ++i) out[i] = v[i];
    return out;
  }

  Eigen::Index joints_;  // coordinates
  Arm arm_;
  ArmPoint at_;
  ForceAtSite<kMostCoordinates, Arm::kJoints> force_;
  std::optional<TouchFinder<kMostCoordinates, Arm::kJoints>> touch_;
};

}  // namespace

std::unique_ptr<const ArmForces> arm_forces(const Model& arm, const ArmForceOptions& o) {
  const ArmTree tree = tree_of(arm);
  if (tree.dof() > kMostCoordinates)
    throw std::invalid_argument(
        fmt::format("{} joints: forces are found of 1 to {}", tree.dof(), kMostCoordinates));
  detail::require_size(tree, tree.dof());
  return std::make_unique<Forces>(tree, o);
}

std::string touched_link(int link, int dof) {
  if (link == 0) return "no link is touched";
  return fmt::format("joint {} carries the link that is touched{}", link,
                     link < dof ? ", or one behind it whose joints' axes the force meets" : "");
}

}  // namespace tauext
