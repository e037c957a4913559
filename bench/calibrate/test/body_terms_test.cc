// SPDX-License-Identifier: Apache-2.0
#include "bench/calibrate/masses/body_terms.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <vector>

#include "bench/calibrate/masses/physical_fit.h"
#include "mjcf/plant/any_tree.h"
#include "mjcf/plant/model.h"

namespace tauext::test {
namespace {

// TreeModel sums spatial inertias over subtrees; without rotors, it is the bodies alone
void expect_same_dynamics(ArmTree arm) {
  for (TreeJoint& j : arm.joints) j.armature = 0;
  std::vector<int> bodies(arm.joints.size());
  std::iota(bodies.begin(), bodies.end(), 0);
  Eigen::VectorXd numbers(kBodyTerms * static_cast<int>(bodies.size()));
  for (const int b : bodies)
    numbers.segment<kBodyTerms>(b * kBodyTerms) =
        body_vector(arm.joints[static_cast<std::size_t>(b)]);
  const BodyTerms terms(arm, bodies);
  const auto model = detail::filled<TiedTree>(arm);
  const int n = arm.dof();
  for (int k = 0; k < 50; ++k) {
    const Eigen::VectorXd q = Eigen::VectorXd::Random(n), qd = 2 * Eigen::VectorXd::Random(n);
    Vec<kMostCoordinates> wide = Vec<kMostCoordinates>::Zero(), rate = wide;
    wide.head(n) = q, rate.head(n) = qd;
    const auto d = model.momentum_dynamics(wide, rate);
    const BodyTerms::At at = terms.at(q, qd);
    const double scale = numbers.norm() * 10;
    EXPECT_LT((at.momentum * numbers - (d.B * rate).head(n)).norm(), 1e-12 * scale) << k;
    EXPECT_LT((at.rest * numbers + d.bias.head(n)).norm(), 1e-12 * scale) << k;
  }
}

TEST(BodyTerms, AddUpToTheDynamicsOfTheTree) {
  expect_same_dynamics(tree_of(load_mjcf("bench/examples/arm6.xml")));
}

// fingers that slide and follow each other
TEST(BodyTerms, AddUpWhereJointsSlideAndFollow) {
  expect_same_dynamics(tree_of(load_mjcf("bench/examples/arm7.xml")));
}

// 2 kg, 0.3 x 0.2 x 0.1 m: its second moments are m a^2 / 12, and at c also m c c^T
TEST(PseudoInertia, OfABoxIsThatOfTheTextbook) {
  TreeJoint j;
  j.mass = 2;
  j.center = {0.1, -0.2, 0.3};
  const Eigen::Vector3d a(0.3, 0.2, 0.1);
  const Eigen::Vector3d Sigma = 2. / 12 * a.cwiseAbs2();
  j.inertia =
      Eigen::Vector3d(Sigma[1] + Sigma[2], Sigma[0] + Sigma[2], Sigma[0] + Sigma[1]).asDiagonal();
  Eigen::Matrix4d P;
  P << Eigen::Matrix3d(Sigma.asDiagonal()) + 2 * j.center * j.center.transpose(), 2 * j.center,
      2 * j.center.transpose(), 2;
  EXPECT_LT((pseudo_inertia(body_vector(j)) - P).norm(), 1e-12);
  EXPECT_LT((body_vector(P) - body_vector(j)).norm(), 1e-12);
  const MeasuredBody b = body_of(body_vector(j), {0, 0, 0.3});
  EXPECT_NEAR(b.center[2], 0, 1e-12);
  EXPECT_NEAR(b.inertia[1], j.inertia(1, 1), 1e-12);
}

class PhysicalFit : public testing::Test {
 protected:
  PhysicalFit() {
    P0_.diagonal() << 0.02, 0.02, 0.03, 1.5;
    prior_ = {body_vector(P0_)};
  }
  // a measurement of the mass alone, with that weight
  BodyVector fitted(double mass, double weight) const {
    Quadratic d{Eigen::MatrixXd::Zero(kBodyTerms, kBodyTerms), Eigen::VectorXd::Zero(kBodyTerms)};
    d.H(0, 0) = weight, d.b[0] = weight * mass;
    return physical_fit(d, prior_);
  }

  Eigen::Matrix4d P0_ = Eigen::Matrix4d::Zero();
  std::vector<BodyVector> prior_;
};

TEST_F(PhysicalFit, IsThePriorWhereNothingIsMeasured) {
  EXPECT_LT((fitted(7, 0) - prior_[0]).norm(), 1e-9);
}

// w (m - m1) + 1/m0 - 1/m = 0, whose positive root is known
TEST_F(PhysicalFit, HasTheLeastValueOfItsFormula) {
  for (const double w : {0.1, 1., 100.})
    for (const double m1 : {-3., 0., 0.5, 4.}) {
      const double half = (w * m1 - 1 / 1.5) / (2 * w);
      const double m = half + std::sqrt(half * half + 1 / w);
      EXPECT_NEAR(fitted(m1, w)[0], m, 1e-6 * m) << w << " " << m1;
    }
}

// a moment of inertia beyond the sum of the others, and a mass below 0, are asked for
TEST_F(PhysicalFit, IsABodyWhateverIsMeasured) {
  Quadratic d{1e6 * Eigen::MatrixXd::Identity(kBodyTerms, kBodyTerms),
              Eigen::VectorXd::Zero(kBodyTerms)};
  d.b << -1e6, 1e6, 0, 0, 1e6, 1e5, 1e5, 0, 0, 0;
  const BodyVector b = physical_fit(d, prior_);
  EXPECT_EQ(Eigen::LLT<Eigen::Matrix4d>(pseudo_inertia(b)).info(), Eigen::Success);
  EXPECT_GT(b[0], 0);
  EXPECT_LT(b[4], b[5] + b[6]);
}

}  // namespace
}  // namespace tauext::test
