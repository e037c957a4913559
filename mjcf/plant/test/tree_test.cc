// SPDX-License-Identifier: Apache-2.0
// MuJoCo is the oracle, asked by arm_dynamics.h, and closed forms that were made from the paper.
#include "mjcf/plant/tree.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>
#include <unistd.h>

#include <Eigen/Geometry>
#include <filesystem>
#include <fstream>
#include <random>
#include <stdexcept>

#include "estimators/wallmobot3.h"
#include "mjcf/plant/plant.h"
#include "mjcf/plant/test/arm_dynamics.h"

namespace tauext::test {
namespace {

// Random numbers of a fixed seed.
class Random {
 public:
  explicit Random(unsigned seed) : engine_(seed) {}
  double operator()(double most) { return std::uniform_real_distribution(-most, most)(engine_); }
  int below(int n) { return std::uniform_int_distribution(0, n - 1)(engine_); }
  template <int N>
  Vec<N> vector(double most) {
    return Vec<N>::NullaryExpr([&] { return (*this)(most); });
  }
  std::string numbers(int n, double most) {
    std::string all;
    for (int i = 0; i < n; ++i) all += fmt::format("{} ", (*this)(most));
    return all;
  }

 private:
  std::mt19937_64 engine_;
};

// Loads MJCF text.
Model model_of(const std::string& xml) {
  const auto path =
      std::filesystem::temp_directory_path() / fmt::format("tauext_tree_{}.xml", ::getpid());
  std::ofstream(path) << xml;
  const Model m = load_mjcf(path.string());
  std::filesystem::remove(path);
  return m;
}

// A body with some of the joints that are left, what hangs on it, and sometimes a body that is
// fixed to it or two joints at once.
std::string body(Random& random, int& left) {
  std::string xml =
      fmt::format("<body pos='{}' euler='{}'>", random.numbers(3, 0.4), random.numbers(3, 90));
  for (int joints = 1 + (random.below(4) == 0); joints > 0 && left > 0; --joints, --left) {
    xml += fmt::format(
        "<joint type='{}' axis='{}' pos='{}' ref='{}' armature='{}' damping='0.3' "
        "frictionloss='0.2'/>",
        random.below(4) == 0 ? "slide" : "hinge", random.numbers(3, 1), random.numbers(3, 0.1),
        random(0.5), 0.1 + random(0.1));
  }
  xml += fmt::format("<geom type='box' size='0.05 0.1 0.2' pos='{}' euler='{}' mass='{}'/>",
                     random.numbers(3, 0.2), random.numbers(3, 90), 2 + random(1));
  if (random.below(3) == 0)
    xml += fmt::format(
        "<body pos='{}' euler='{}'><geom type='capsule' size='0.05 0.1' mass='0.7'/></body>",
        random.numbers(3, 0.3), random.numbers(3, 90));
  while (left > 0 && random.below(3) != 0) xml += body(random, left);
  return xml + "</body>";
}

// A tree of n hinges and slides.
Model random_tree(unsigned seed, int n) {
  Random random(seed);
  std::string bodies;
  for (int left = n; left > 0;) bodies += body(random, left);
  return model_of(fmt::format(
      "<mujoco><compiler angle='degree'/><option gravity='{}'/><worldbody>"
      "<body pos='3 -2 1' euler='20 30 40'><geom size='0.1'/>{}</body></worldbody></mujoco>",
      random.numbers(3, 9), bodies));
}

// The largest differences from MuJoCo over random states, as shares of the largest value.
template <int N>
void expect_mujocos_terms(const Model& model, int states, unsigned seed) {
  const MjcfArm<N> oracle(model);
  const TreeModel<N> tree = tree_model<N>(model);
  Random random(seed);
  for (int k = 0; k < states; ++k) {
    const Vec<N> q = random.vector<N>(3), qd = random.vector<N>(2);
    const Mat<N> B = oracle.inertia(q);
    const Vec<N> bias = oracle.bias(q, qd), g = oracle.gravity(q);
    const double scale = bias.norm() + g.norm() + B.norm();  // [N m]; of 1 rad/s^2
    ASSERT_LT((tree.inertia(q) - B).norm(), 1e-10 * B.norm());
    ASSERT_LT((tree.bias(q, qd) - bias).norm(), 1e-10 * scale);
    ASSERT_LT((tree.gravity(q) - g).norm(), 1e-10 * scale);
    ASSERT_LT((tree.friction(qd) - oracle.friction(qd)).norm(), 1e-10 * (1 + qd.norm()));
    // by differences of fourth order, 0.01 rad wide
    ASSERT_LT((tree.momentum_bias(q, qd) - oracle.momentum_bias(q, qd)).norm(), 1e-6 * scale);
  }
}

TEST(Tree, HasMuJoCosTermsOfEveryRobotOfOurs) {
  expect_mujocos_terms<3>(load_robot("wallmobot3"), 1000, 1);
  expect_mujocos_terms<1>(load_robot("testbed1"), 1000, 2);
  expect_mujocos_terms<6>(load_robot("wallmobot6"), 1000, 3);
}

TEST(Tree, HasMuJoCosTermsOfRandomTrees) {
  for (unsigned seed = 0; seed < 10; ++seed) {
    expect_mujocos_terms<1>(random_tree(seed, 1), 100, seed);
    expect_mujocos_terms<2>(random_tree(seed, 2), 100, seed);
    expect_mujocos_terms<5>(random_tree(seed, 5), 100, seed);
    expect_mujocos_terms<6>(random_tree(seed, 6), 100, seed);
    expect_mujocos_terms<7>(random_tree(seed, 7), 100, seed);
    expect_mujocos_terms<8>(random_tree(seed, 8), 100, seed);
  }
}

// a point of each body, and its Jacobian by mj_jac
template <int N>
void expect_mujocos_jacobians(const Model& model, unsigned seed) {
  const mjModel& m = *model;
  const State d(mj_makeData(&m));
  const TreeModel<N> tree = tree_model<N>(model);
  const Vec<3> base = tree_of(model).base;
  Random random(seed);
  const Vec<N> q = random.vector<N>(3);
  Vec<N>::Map(d->qpos) = q;
  mj_kinematics(&m, d.get());
  mj_comPos(&m, d.get());
  for (int b = 1; b < m.nbody; ++b) {
    if (m.body_jntnum[b] == 0) continue;
    const int joint = m.body_jntadr[b] + m.body_jntnum[b] - 1;
    const Vec<3> point = random.vector<3>(0.3), anchor = Vec<3>::Map(m.jnt_pos + 3 * joint);
    const Vec<3> at =  // in the world; MuJoCo's matrices are row by row
        Vec<3>::Map(d->xpos + 3 * b) + Mat<3>::Map(d->xmat + 9 * b).transpose() * point;
    Eigen::Matrix<double, 3, N, N == 1 ? Eigen::ColMajor : Eigen::RowMajor> linear, angular;
    mj_jac(&m, d.get(), linear.data(), angular.data(), at.data(), b);
    const Eigen::Matrix<double, 6, N> J = tree.jacobian(q, joint, point - anchor);
    ASSERT_LT((J.template topRows<3>() - linear).norm(), 1e-12);
    ASSERT_LT((J.template bottomRows<3>() - angular).norm(), 1e-12);
    ASSERT_LT((base + tree.position(q, joint, point - anchor) - at).norm(), 1e-12);
  }
}

TEST(Tree, HasMuJoCosJacobians) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    expect_mujocos_jacobians<1>(random_tree(seed, 1), seed);
    expect_mujocos_jacobians<4>(random_tree(seed, 4), seed);
    expect_mujocos_jacobians<7>(random_tree(seed, 7), seed);
  }
}

TEST(Tree, IsTheClosedFormOfWallMoBot3) {
  const TreeModel<3> tree = tree_model<3>(load_robot("wallmobot3"));
  const WallMoBot3 closed;
  Random random(3);
  for (int k = 0; k < 1000; ++k) {
    const Vec<3> q = random.vector<3>(3), qd = random.vector<3>(2), u = random.vector<3>(500);
    const ForwardDynamics<3> a = tree.forward_dynamics(q, qd, u),
                             b = closed.forward_dynamics(q, qd, u);
    ASSERT_LT((tree.momentum_bias(q, qd) - closed.momentum_bias(q, qd)).norm(), 1e-9 * 1e3);
    ASSERT_LT((a.qdd - b.qdd).norm(), 1e-9 * (1 + b.qdd.norm()));
    ASSERT_LT((a.dqdd_dq - b.dqdd_dq).norm(), 1e-9 * (1 + b.dqdd_dq.norm()));
    ASSERT_LT((a.dqdd_dqd - b.dqdd_dqd).norm(), 1e-9 * (1 + b.dqdd_dqd.norm()));
    ASSERT_LT((a.dqdd_dtau_ext - b.dqdd_dtau_ext).norm(), 1e-9 * b.dqdd_dtau_ext.norm());
  }
}

TEST(Tree, OfWallMoBot6IsWallMoBot3WhereTheOtherJointsRest) {
  const TreeModel<6> whole = tree_model<6>(load_robot("wallmobot6"));
  const WallMoBot3 planar;
  Random random(4);
  for (int k = 0; k < 1000; ++k) {
    const Vec<3> q = random.vector<3>(3), qd = random.vector<3>(2);
    const auto wide = [](const Vec<3>& v) { return Vec<6>(0, v[0], v[1], v[2], 0, 0); };
    const Mat<3> B = planar.inertia(q);
    const Vec<3> n = planar.bias(q, qd);
    const Mat<3> B6 = whole.inertia(wide(q)).block<3, 3>(1, 1);
    const Vec<3> n6 = whole.bias(wide(q), wide(qd)).segment<3>(1);
    ASSERT_LT((B6 - B).norm(), 1e-10 * B.norm());
    ASSERT_LT((n6 - n).norm(), 1e-10 * (1 + n.norm()));
  }
}

// Table I as it is printed, with a_i-1 and alpha_i-1 before theta_i and d_i; 0.9 m of platform
// below it, and delta_x = 0.2025 m beyond frame 7
TEST(Tree, OfWallMoBot6EndsWhereTableIPutsIt) {
  constexpr double kHalf = 1.5707963267948966, kGamma = 0.3458;
  const Model model = load_robot("wallmobot6");
  Plant plant(model);
  Random random(5);
  for (int k = 0; k < 100; ++k) {
    const Vec<6> q = random.vector<6>(2);
    const double table[7][4] = {{0, 0, q[0], 0},
                                {0.06, 0, q[1] - kHalf, -kHalf},
                                {0.5, 0, -q[1] + kGamma, 0},
                                {0.195, 0, q[2] + kHalf - kGamma, 0},
                                {0.85, 0, q[3] + kHalf, 0},
                                {0.93, 0.109, q[4] + kHalf, kHalf},
                                {0, 0, q[5] - kHalf, -kHalf}};
    Eigen::Isometry3d T(Eigen::Translation3d(0, 0, 0.9));
    for (const auto& [a, d, theta, alpha] : table) {
      T = T * Eigen::AngleAxisd(alpha, Vec<3>::UnitX()) * Eigen::Translation3d(a, 0, 0) *
          Eigen::AngleAxisd(theta, Vec<3>::UnitZ()) * Eigen::Translation3d(0, 0, d);
    }
    plant.set_state(q, Vec<6>::Zero());
    ASSERT_LT((plant.end_effector().position - T * Vec<3>(0.2025, 0, 0)).norm(), 1e-12);
  }
}

TEST(Tree, AnotherNumberOfJointsIsRefused) {
  EXPECT_THROW(tree_model<2>(load_robot("wallmobot3")), std::invalid_argument);
}

}  // namespace
}  // namespace tauext::test
