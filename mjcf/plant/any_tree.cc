// SPDX-License-Identifier: Apache-2.0
#include "mjcf/plant/any_tree.h"

namespace tauext {

template class TreeModel<kMostCoordinates, double, kMostCoordinates + kMostFollowers>;

namespace detail {

std::shared_ptr<const TiedTree> tied_tree(const ArmTree& tree) {
  return std::make_shared<const TiedTree>(filled<TiedTree>(tree));
}

Tied::MatN Tied::inertia(const TiedTree& arm, const VecN& q) noexcept {
  return arm.inertia(q);
}
Tied::VecN Tied::gravity(const TiedTree& arm, const VecN& q) noexcept {
  return arm.gravity(q);
}
Tied::VecN Tied::bias(const TiedTree& arm, const VecN& q, const VecN& qd) noexcept {
  return arm.bias(q, qd);
}
Tied::VecN Tied::momentum_bias(const TiedTree& arm, const VecN& q, const VecN& qd) noexcept {
  return arm.momentum_bias(q, qd);
}
Tied::VecN Tied::friction(const TiedTree& arm, const VecN& qd) noexcept {
  return arm.friction(qd);
}
Tied::VecN Tied::dry_friction(const TiedTree& arm, const VecN& qd) noexcept {
  return arm.dry_friction(qd);
}
Tied::Both Tied::dynamics(const TiedTree& arm, const VecN& q, const VecN& qd) noexcept {
  return arm.dynamics(q, qd);
}
Tied::Both Tied::momentum_dynamics(const TiedTree& arm, const VecN& q, const VecN& qd) noexcept {
  return arm.momentum_dynamics(q, qd);
}
ForwardDynamics<kMostCoordinates> Tied::forward_dynamics(const TiedTree& arm, const VecN& q,
                                                         const VecN& qd, const VecN& u) noexcept {
  return arm.forward_dynamics(q, qd, u);
}
LinearMotion<kMostCoordinates> Tied::motion(const TiedTree& arm, const VecN& q, const VecN& qd,
                                            const VecN& u, Block<kMostCoordinates>* B) noexcept {
  return arm.motion(q, qd, u, B);
}

}  // namespace detail

std::function<Eigen::VectorXd(const Eigen::VectorXd&)> gravity_of(const ArmTree& arm) {
  return [model = detail::tied_tree(arm), n = arm.dof()](const Eigen::VectorXd& q) {
    detail::Tied::VecN all = detail::Tied::VecN::Zero();
    all.head(n) = q;
    return Eigen::VectorXd(model->gravity(all).head(n));
  };
}

void add_gravity(Trace& trace, const ArmTree& arm) {
  if (!trace.tau_without_gravity) return;
  detail::require_size(arm, trace.dof());
  const auto gravity = gravity_of(arm);
  for (int k = 0; k < trace.size(); ++k) trace.tau.col(k) += gravity(trace.q.col(k));
  trace.tau_without_gravity = false;
}

}  // namespace tauext
