// SPDX-License-Identifier: Apache-2.0
// The terms themselves are checked against MuJoCo in mjcf/plant/test/tree_test.cc; here is what
// must hold between them, by complex steps, which are exact to the last digits.
#include "estimators/tree/tree_model.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <stdexcept>
#include <string>
#include <vector>

#include "estimators/test/random_tree.h"
#include "estimators/tree/run_terms.h"

namespace tauext::test {
namespace {

using Complex = std::complex<double>;

constexpr double kStep = 1e-100;  // of a complex step

template <int N>
Vec<N, Complex> complex(const Vec<N>& re, const Vec<N>& im) {
  return re.template cast<Complex>() + Complex(0, kStep) * im;
}

template <int N, int M = N>
void expect_consistent(unsigned seed) {
  SCOPED_TRACE(std::to_string(N) + " of " + std::to_string(M) + " joints, tree " +
               std::to_string(seed));
  RandomTree<N, M> r(seed);
  const TreeModel<N, double, M> tree = r.template model<double>();
  const auto exact = r.template model<Complex>();
  const Vec<N> q = r.template vector<N>(2), qd = r.template vector<N>(2),
               u = r.template vector<N>(9);
  const Vec<N> zero = Vec<N>::Zero();
  const Mat<N> B = tree.inertia(q);
  const Mat<N> Bdot = exact.inertia(complex(q, qd)).imag() / kStep;
  const Vec<N> Cqd = tree.bias(q, qd) - tree.gravity(q);
  const double scale = tree.bias(q, qd).norm() + B.norm() + u.norm();

  EXPECT_LT((B - B.transpose()).norm(), 1e-14 * B.norm());
  EXPECT_NEAR(qd.dot(Cqd), 0.5 * qd.dot(Bdot * qd), 1e-12 * scale) << "power";
  EXPECT_LT((tree.momentum_bias(q, qd) - (Bdot * qd - tree.bias(q, qd))).norm(), 1e-12 * scale);
  EXPECT_EQ(dynamics(tree, q, qd).B, B);
  EXPECT_LT((dynamics(tree, q, qd).bias - tree.bias(q, qd)).norm(), 1e-13 * scale);
  const Dynamics<N> m = tree.momentum_dynamics(q, qd);
  EXPECT_LT((m.bias - tree.momentum_bias(q, qd)).norm() + (m.B - B).norm(), 1e-13 * scale);

  const ForwardDynamics<N> f = tree.forward_dynamics(q, qd, u);
  detail::Block<N> lanes_of_B;
  const auto lanes = tree.motion(q, qd, u, &lanes_of_B);
  EXPECT_LT((lanes_of_B.matrix() - B).norm(), 1e-14 * B.norm());
  for (const detail::Block<N>& block : {lanes_of_B, lanes.by_q, lanes.by_qd, lanes.minus_inverse}) {
    for (int i = N; i < detail::kPadded<N>; ++i) {
      for (const auto& column : block.column) EXPECT_EQ(column[i], 0) << "zeros are appended";
    }
  }
  ASSERT_TRUE(f.ok);
  EXPECT_LT((B * f.qdd + tree.bias(q, qd) + tree.friction(qd) - u).norm(), 1e-12 * scale);
  EXPECT_LT((B * f.dqdd_dtau_ext + Mat<N>::Identity()).norm(), 1e-12 * N);
  Mat<N> by_q, by_qd;  // of the torques at this qdd
  for (int j = 0; j < N; ++j) {
    const Vec<N, Complex> at = complex(q, Vec<N>(Vec<N>::Unit(j))),
                          v = complex(qd, Vec<N>(Vec<N>::Unit(j)));
    const Vec<N, Complex> still = complex(q, zero), rate = complex(qd, zero);
    by_q.col(j) = (exact.inertia(at) * f.qdd + exact.bias(at, rate)).imag() / kStep;
    by_qd.col(j) = (exact.bias(still, v) + exact.friction(v)).imag() / kStep;
  }
  EXPECT_LT((B * f.dqdd_dq + by_q).norm(), 1e-12 * (by_q.norm() + scale));
  EXPECT_LT((B * f.dqdd_dqd + by_qd).norm(), 1e-12 * (by_qd.norm() + scale));
}

TEST(TreeModel, TermsAndDerivativesAreThoseOfOneArm) {
  for (unsigned seed = 0; seed < 40; ++seed) {
    expect_consistent<1>(seed);
    expect_consistent<3>(seed);
    expect_consistent<7>(seed);
    expect_consistent<2, 10>(seed);
  }
}

// what holds joints together does no work: the whole arm's terms, projected
TEST(TreeModel, OfTiedJointsIsTheWholeArmAlongItsCoordinates) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    RandomTree<3, 7> r(seed);
    const TreeModel<7> whole({r.joints, {1, 2, -9}});
    const auto tied = r.model<double>();
    const Vec<3> q = r.vector<3>(2), qd = r.vector<3>(2), u = r.vector<3>(9);
    const Vec<7> rho = r.drho * q + Vec<7>::Constant(0.1), rate = r.drho * qd;
    const Mat<7> B = whole.inertia(rho);
    const Vec<7> forces = whole.bias(rho, rate) + whole.friction(rate);
    EXPECT_LT((tied.inertia(q) - r.drho.transpose() * B * r.drho).norm(), 1e-12 * B.norm());
    EXPECT_LT((tied.gravity(q) - r.drho.transpose() * whole.gravity(rho)).norm(), 1e-11);
    // the joints go as drho says, and what then is missing of their forces does no work
    const Vec<7> rest = B * (r.drho * tied.forward_dynamics(q, qd, u).qdd) + forces;
    EXPECT_LT((r.drho.transpose() * rest - u).norm(), 1e-11 * forces.norm());
    for (int j = 0; j < 7; ++j) {
      const Vec<3> at(0.1, -0.2, 0.3);
      EXPECT_LT((tied.jacobian(q, j, at) - whole.jacobian(rho, j, at) * r.drho).norm(), 1e-13);
    }
  }
}

TEST(TreeModel, RefusesJointsThatAreNone) {
  const auto error = [](auto&& spoil) -> std::string {
    RandomTree<2> r(1);
    spoil(r);
    try {
      r.model<double>();
    } catch (const std::invalid_argument& e) {
      return e.what();
    }
    return "no error";
  };
  EXPECT_EQ(error([](auto&) {}), "no error");
  const auto refuses = [&](auto&& spoil, const std::string& why) {
    EXPECT_NE(error(spoil).find(why), std::string::npos) << error(spoil);
  };
  refuses([](auto& r) { r.joints[0].parent = 0; }, "joint 1 of a tree: its parent");
  refuses([](auto& r) { r.joints[1].axis.setZero(); }, "joint 2 of a tree: its axis");
  refuses([](auto& r) { r.joints[1].rotation *= 2; }, "its rotation");
  refuses([](auto& r) { r.joints[1].mass = -1; }, "its mass");
  refuses([](auto& r) { r.joints[1].inertia(0, 1) += 1; }, "its inertia");
  refuses([](auto& r) { r.joints[1].armature = -1; }, "armature");
  refuses([](auto& r) { r.joints[0].v_s = 0; }, "v_s above 0");
  refuses([](auto& r) { r.drho.setZero(); }, "full rank");
  refuses([](auto& r) { r.drho.col(1) = 0.1 * r.drho.col(0); }, "full rank");
  refuses([](auto& r) { r.drho(0, 0) = NAN; }, "finite");
  RandomTree<3> permuted(1);
  permuted.drho << 0, 1, 0, 0, 0, 2, 1, 0, 0;
  EXPECT_NO_THROW(permuted.model<double>());
}

TEST(TreeModel, SaysWhereItIsSingular) {
  RandomTree<2> r(1);
  for (TreeJoint& j : r.joints) j.mass = j.armature = 0, j.inertia.setZero();
  const Vec<2> x = Vec<2>::Ones();
  EXPECT_FALSE(r.model<double>().forward_dynamics(x, x, x).ok);
}

TEST(RunTerms, AreComputedOnceAtASampleAndAlwaysElsewhere) {
  const std::array<double, 5> q{0, 1, 2, 3, 4}, qd{};
  RunTerms<1> terms({.joints = 1, .size = 5, .q = q.data(), .qd = qd.data()});
  int computed = 0;
  const auto ask = [&](RunTerms<1>::At& at, double x, double speed = 0) {
    const auto compute = [&] {
      ++computed;
      return Dynamics<1>{Mat<1>(x), Vec<1>(speed)};
    };
    return terms.dynamics(at, Vec<1>(x), Vec<1>(speed), compute).B(0, 0);
  };
  RunTerms<1>::At first = 0, second = 0;
  for (const double x : q) EXPECT_EQ(ask(first, x), x);
  EXPECT_EQ(computed, 5);
  for (const double x : {0., 0., 1., 4.}) EXPECT_EQ(ask(second, x), x) << "two left out";
  EXPECT_EQ(computed, 5);
  EXPECT_EQ(ask(second, 4, 0.1), 4) << "another speed";
  EXPECT_EQ(ask(second, 0.5), 0.5) << "no sample";
  EXPECT_EQ(ask(second, 0), 0) << "one of the past";
  EXPECT_EQ(computed, 8);
  RunTerms<1>::At other = 0;
  terms.momentum_dynamics(other, Vec<1>(0.), Vec<1>(0.), [&] {
    ++computed;
    return Dynamics<1>();
  });
  EXPECT_EQ(computed, 9) << "another function";
}

}  // namespace
}  // namespace tauext::test
