// SPDX-License-Identifier: Apache-2.0
/// @file
/// What terms of joints (joint_fit.h) are free in a fit of all joints together, and what is held:
/// armature and friction at 0, and a skew of viscous friction at all of that.
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "bench/calibrate/joint_fit.h"
#include "bench/calibrate/masses/window_sums.h"

namespace tauext {

/// Of some joints, whose terms stand in theta behind `before` other numbers.
class JointBounds {
 public:
  JointBounds(int before, int joints);  ///< all are free

  /// theta = (this) phi, of what is free.
  Eigen::MatrixXd freedom() const;
  /// Holds the term that is furthest beyond what a joint can have, in standard errors.
  /// @param found is told which term of which joint that is, and how far beyond
  /// @returns whether there was one
  template <class Found>
  bool hold(const Eigen::VectorXd& theta, const Eigen::VectorXd& errors, Found&& found) {
    int joint = 0, term = 0;
    double much = 0;
    if (!furthest(theta, errors, joint, term, much)) return false;
    found(joint, term, much);
    take(joint, term, theta[at(joint, term)] < 0);
    return true;
  }
  /// The number in theta of a joint's term.
  int at(int joint, int term) const { return before_ + joint * kTermsOfJoint + term; }

 private:
  enum class Is { kFree, kZero, kViscous, kMinusViscous };

  bool furthest(const Eigen::VectorXd& theta, const Eigen::VectorXd& errors, int& joint, int& term,
                double& much) const;
  void take(int joint, int term, bool negative);

  int before_;
  std::vector<std::array<Is, kTermsOfJoint>> joints_;
};

}  // namespace tauext
