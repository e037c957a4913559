// SPDX-License-Identifier: Apache-2.0
#include "bench/calibrate/masses/joint_bounds.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string_view>

namespace tauext {
namespace {

// the place of a term in kJointTerms
int term_number(std::string_view name) {
  const auto* const at = std::find_if(std::begin(kJointTerms), std::end(kJointTerms),
                                      [&](const JointTerm& t) { return name == t.name; });
  return static_cast<int>(at - std::begin(kJointTerms));
}

}  // namespace

JointBounds::JointBounds(int before, int joints) : before_(before) {
  std::array<Is, kTermsOfJoint> free;
  free.fill(Is::kFree);
  joints_.assign(static_cast<std::size_t>(joints), free);
}

Eigen::MatrixXd JointBounds::freedom() const {
  const int n = at(static_cast<int>(joints_.size()), 0), viscous = term_number("viscous");
  Eigen::MatrixXd T = Eigen::MatrixXd::Zero(n, n);
  int columns = before_;
  T.leftCols(before_).topRows(before_).setIdentity();
  for (std::size_t j = 0; j < joints_.size(); ++j) {
    const int joint = static_cast<int>(j);
    for (int k = 0; k < kTermsOfJoint; ++k)
      if (joints_[j][static_cast<std::size_t>(k)] == Is::kFree) T(at(joint, k), columns++) = 1;
    const Is skew = joints_[j][static_cast<std::size_t>(term_number("viscous_skew"))];
    if (skew == Is::kViscous || skew == Is::kMinusViscous)
      T.row(at(joint, term_number("viscous_skew"))) =
          (skew == Is::kViscous ? 1 : -1) * T.row(at(joint, viscous));
  }
  return T.leftCols(columns);
}

bool JointBounds::furthest(const Eigen::VectorXd& theta, const Eigen::VectorXd& errors, int& joint,
                           int& term, double& much) const {
  const int viscous = term_number("viscous"), skew = term_number("viscous_skew"),
            offset = term_number("offset");
  double most = 0;
  for (int j = 0; j < static_cast<int>(joints_.size()); ++j) {
    for (int k = 0; k < kTermsOfJoint; ++k) {
      const bool free =
          joints_[static_cast<std::size_t>(j)][static_cast<std::size_t>(k)] == Is::kFree;
      if (!free || k == offset) continue;
      const double x = theta[at(j, k)];
      const double beyond = k == skew ? std::abs(x) - std::max(theta[at(j, viscous)], 0.) : -x;
      if (beyond <= 1e-12 * std::abs(x)) continue;
      const double errors_beyond = beyond / std::max(errors[at(j, k)], 1e-300);
      if (errors_beyond <= most) continue;
      most = errors_beyond, joint = j, term = k, much = beyond;
    }
  }
  return most > 0;
}

void JointBounds::take(int joint, int term, bool negative) {
  Is& is = joints_[static_cast<std::size_t>(joint)][static_cast<std::size_t>(term)];
  is = term != term_number("viscous_skew") ? Is::kZero
       : negative                          ? Is::kMinusViscous
                                           : Is::kViscous;
}

}  // namespace tauext
