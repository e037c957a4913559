// SPDX-License-Identifier: Apache-2.0
#include "mjcf/simulation/tree_plant.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <utility>

namespace tauext {

TreePlant::TreePlant(PlainArm arm, std::shared_ptr<const TreeMotion> motion)
    : arm_(std::move(arm)),
      motion_(std::move(motion)),
      s_(arm_.tree.dof()),
      end_(arm_.tree.point(kEndEffector)),
      least_(arm_.least),
      most_(arm_.most),
      drho_(arm_.tree.drho),
      lowest_(arm_.lowest - arm_.tree.rho0),
      highest_(arm_.highest - arm_.tree.rho0) {}

void TreePlant::set_state(const Vector& q, const Vector& qd) {
  s_.q = q, s_.qd = qd;
  s_.tau.setZero(), s_.tau_ext.setZero();
  motion_->look(s_);
}

void TreePlant::set_input(const Vector& tau, const Vector& tau_ext) {
  s_.tau = tau.cwiseMax(least_).cwiseMin(most_);
  s_.tau_ext = tau_ext;
  motion_->accelerate(s_);
}

void TreePlant::step(std::span<TreePlant* const> all, double h) {
  std::array<TreeState*, 16> runs;
  while (!all.empty()) {
    const std::size_t n = std::min(all.size(), runs.size());
    for (std::size_t i = 0; i < n; ++i) runs[i] = &all[i]->s_;
    all.front()->motion_->step({runs.data(), n}, h);
    all = all.subspan(n);
  }
}

ArmPoint TreePlant::place(const std::string& name) const {
  return arm_.tree.point(name);
}

Point TreePlant::point(const ArmPoint& at) const {
  Point there = motion_->point(s_, at);
  there.position += arm_.tree.base;
  return there;
}

bool TreePlant::is_lost() const {
  const Vector moved = drho_.lazyProduct(s_.q);
  return !(moved.array() > lowest_.array()).all() || !(moved.array() < highest_.array()).all() ||
         !s_.qd.allFinite() || !s_.qdd.allFinite();
}

}  // namespace tauext
