// SPDX-License-Identifier: Apache-2.0
// Arms of any shape: hinges and slides, chains and trees, in coordinates that are not the joints',
// which may be fewer.
#pragma once

#include <array>
#include <random>

#include "estimators/tree/tree_model.h"

namespace tauext::test {

template <int N, int M = N>
struct RandomTree {
  explicit RandomTree(unsigned seed) : random(seed) {
    for (int i = 0; i < M; ++i) {
      TreeJoint& j = joints[static_cast<std::size_t>(i)];
      j.parent = static_cast<int>(std::uniform_int_distribution(-1, i - 1)(random));
      if (i % 3 == 1) j.kind = TreeJoint::Kind::kSlide;
      j.axis = vector<3>(1);
      j.rotation =
          Eigen::AngleAxis<double>(number(3), vector<3>(1).normalized()).toRotationMatrix();
      j.position = vector<3>(0.5);
      j.zero = number(1);
      j.mass = 2 + number(1);
      j.center = vector<3>(0.2);
      const Mat<3> half = Mat<3>::NullaryExpr([&] { return number(0.3); });
      j.inertia = half * half.transpose() + 0.1 * Mat<3>::Identity();
      j.armature = 0.2;
      j.viscous = 0.3;
      j.viscous_skew = number(0.3);
      j.dry = 0.4;
      j.offset = number(1);
      j.v_s = 0.5;
    }
    drho = Drho::Identity() + 0.2 * Drho::NullaryExpr([&] { return number(1); });
  }
  double number(double most) { return std::uniform_real_distribution(-most, most)(random); }
  template <int K>
  Vec<K> vector(double most) {
    return Vec<K>::NullaryExpr([&] { return number(most); });
  }
  template <class Scalar>
  TreeModel<N, Scalar, M> model() const {
    return TreeModel<N, Scalar, M>({joints, {1, 2, -9}, drho, Vec<M>::Constant(0.1)});
  }

  std::mt19937_64 random;
  std::array<TreeJoint, M> joints;
  using Drho = Eigen::Matrix<double, M, N>;
  Drho drho;
};

}  // namespace tauext::test
