// SPDX-License-Identifier: Apache-2.0
#include "estimators/force/site_force.h"

#include <gtest/gtest.h>

#include "estimators/force/touch_place.h"

namespace tauext::test {
namespace {

// A chain of hinges about axes in turn, 0.3 m apart.
template <int N>
TreeModel<N> chain(const Vec<3> (&axes)[3]) {
  typename TreeModel<N>::Parameters p;
  for (int i = 0; i < N; ++i) {
    TreeJoint& j = p.joints[static_cast<std::size_t>(i)];
    j.parent = i - 1;
    j.axis = axes[i % 3];
    j.position = Vec<3>(0.05, 0, i == 0 ? 0 : 0.3);
    j.mass = 1;
    j.center = Vec<3>(0, 0, 0.15);
    j.inertia = 0.01 * Mat<3>::Identity();
  }
  return TreeModel<N>(p);
}
const Vec<3> kAllWays[] = {Vec<3>::UnitZ(), Vec<3>::UnitY(), Vec<3>::UnitX()};
const Vec<3> kPlane[] = {Vec<3>::UnitY(), Vec<3>::UnitY(), Vec<3>::UnitY()};

// Numbers between -most and most.
template <int N>
Vec<N> numbers(double most, int k) {
  return Vec<N>::NullaryExpr(
      [&](auto i) { return most * std::sin(12.9898 * static_cast<double>(i + 1) + 78.233 * k); });
}

// tau_ext of a force and a moment at a point, by the principle of virtual work: the power that the
// point's motion takes from them, by differences of where it is
template <int N>
Vec<N> work(const TreeModel<N>& arm, const Vec<N>& q, const ArmPoint& at, const Vec<3>& force) {
  constexpr double h = 1e-5;
  Vec<N> tau;
  for (int i = 0; i < N; ++i) {
    const Vec<N> d = h * Vec<N>::Unit(i);
    const auto x = [&](const Vec<N>& pose) { return arm.position(pose, at.joint, at.place); };
    const Vec<3> moves =
        (8 * (x(q + d) - x(q - d)) - (x(q + 2 * d) - x(q - 2 * d))) / (12 * h);  // fourth order
    tau[i] = -force.dot(moves);
  }
  return tau;
}

TEST(SiteForce, OfATouchIsItsForce) {
  const auto arm = chain<4>(kAllWays);
  const ArmPoint at{3, {0.02, 0.1, 0.3}};
  const ForceAtSite<4> find(arm, at);
  for (int k = 0; k < 100; ++k) {
    const Vec<4> q = numbers<4>(2, k);
    const Vec<3> f = numbers<3>(100, 3 * k);
    const SiteForce s = find(q, work(arm, q, at, f));
    if (s.seen.head<3>().minCoeff() < 1 - 1e-9) continue;
    EXPECT_LT((s.force - f).norm(), 1e-6) << "where differences have 1e-9 of a metre";
    EXPECT_LT(s.left_over, 1e-7);
    EXPECT_EQ(s.moment, Vec<3>(Vec<3>::Zero()));
  }
}

TEST(SiteForce, OfForceAndMomentIsExactWhereBothAreSeen) {
  const auto arm = chain<7>(kAllWays);
  const ArmPoint at{6, {0.02, 0.1, 0.2}};
  const ForceAtSite<7> find(arm, at, {.moment = true});
  int seen = 0;
  for (int k = 0; k < 100; ++k) {
    const Vec<7> q = numbers<7>(2, k);
    const Vec<6> w = numbers<6>(50, 3 * k);
    const SiteForce s = find(q, Vec<7>(-arm.jacobian(q, at.joint, at.place).transpose() * w));
    if (s.seen.minCoeff() < 1 - 1e-9) continue;
    ++seen;
    EXPECT_LT((s.force - w.head<3>()).norm(), 1e-9);
    EXPECT_LT((s.moment - w.tail<3>()).norm(), 1e-9);
    EXPECT_LT(s.left_over, 1e-9);
    EXPECT_LT(s.condition, 51) << "of levers longer than a fiftieth of the longest";
  }
  EXPECT_GT(seen, 50);
}

TEST(SiteForce, OfAPlaneArmSaysThatItSeesNothingAcross) {
  const auto arm = chain<3>(kPlane);
  const ForceAtSite<3> find(arm, {2, {0, 0, 0.3}});
  const Vec<3> q(0.3, 0.7, -0.4), f(20, 5, -30);
  const SiteForce s = find(q, work(arm, q, {2, {0, 0, 0.3}}, f));
  EXPECT_NEAR(s.force[0], 20, 1e-6);
  EXPECT_NEAR(s.force[1], 0, 1e-9);
  EXPECT_NEAR(s.force[2], -30, 1e-6);
  EXPECT_NEAR(s.seen[0], 1, 1e-12);
  EXPECT_NEAR(s.seen[1], 0, 1e-12);
  EXPECT_NEAR(s.seen[2], 1, 1e-12);
  EXPECT_EQ(s.seen.tail<3>(), Vec<3>(Vec<3>::Zero()));
}

// two links of 1 m: straight, the joints see nothing along them
TEST(SiteForce, FadesWhereAStraightArmSeesItLess) {
  TreeModel<2>::Parameters p;
  for (int i = 0; i < 2; ++i) {
    p.joints[static_cast<std::size_t>(i)].parent = i - 1;
    p.joints[static_cast<std::size_t>(i)].axis = Vec<3>::UnitY();
    p.joints[static_cast<std::size_t>(i)].position = Vec<3>(0, 0, i);
    p.joints[static_cast<std::size_t>(i)].mass = 1;
  }
  const TreeModel<2> arm(p);
  const ArmPoint tip{1, {0, 0, 1}};
  const ForceAtSite<2> find(arm, tip);
  double before = 100;
  for (const double bend : {0.3, 0.03, 0.01, 1e-3, 1e-6, 0.}) {
    const Vec<2> q(0, bend);
    const Vec<3> along(0, 0, 100);
    const SiteForce s =
        find(q, Vec<2>(-arm.jacobian(q, 1, tip.place).topRows<3>().transpose() * along));
    EXPECT_LE(s.force.norm(), before + 1e-9) << bend;
    before = s.force.norm();
    // of a force of 1 N m on each joint no more than 1 / e, however straight
    EXPECT_LT(find(q, Vec<2>(1, 1)).force.norm(), 1.5 / (0.02 * std::sqrt(5))) << bend;
  }
  EXPECT_NEAR(before, 0, 1e-9);
}

TEST(SiteForce, RefusesWhatCannotBe) {
  const auto arm = chain<3>(kPlane);
  EXPECT_THROW(ForceAtSite<3>(arm, {-1, {}}), std::invalid_argument);
  EXPECT_THROW(ForceAtSite<3>(arm, {3, {}}), std::invalid_argument);
  EXPECT_THROW(ForceAtSite<3>(arm, {2, {}}, {.moment = true}), std::invalid_argument);
  EXPECT_THROW(ForceAtSite<3>(arm, {2, {}}, {.least_lever = 0}), std::invalid_argument);
  EXPECT_THROW(TouchFinder<3>(arm, Vec<3>(1, 0, 1)), std::invalid_argument);
}

TEST(TouchPlace, IsTheLinkAndTheLineOfAForceAnywhere) {
  const auto arm = chain<7>(kAllWays);
  const TouchFinder<7> find(arm, Vec<7>::Constant(0.05));
  int right = 0, lines = 0, touches = 0;
  for (int k = 0; k < 700; ++k) {
    const int link = k % 7;
    const Vec<7> q = numbers<7>(2, k);
    const Vec<3> f = 60 * numbers<3>(1, 3 * k).normalized();
    const Vec<3> r = numbers<3>(0.1, 5 * k) + Vec<3>(0, 0, 0.15);
    const Vec<7> tau = -arm.jacobian(q, link, r).topRows<3>().transpose() * f;
    const TouchPlace place = find(q, tau);
    ++touches;
    right += place.link == link;
    EXPECT_LE(place.link, link) << "no joint behind it turns";
    EXPECT_TRUE(!place.has_line || place.link >= 5);
    if (!place.has_line || place.link != link) continue;
    ++lines;
    const Vec<3> way = arm.position(q, link, r) - place.line.point;
    EXPECT_LT(way.cross(place.line.direction).norm(), 1e-9) << "the line meets the touch";
    EXPECT_NEAR(place.line.direction.dot(f), 60, 1e-6);
    EXPECT_NEAR(place.force, 60, 1e-6);
    EXPECT_NEAR(place.line.pitch, 0, 1e-9);
  }
  EXPECT_GE(right, 0.98 * touches);
  EXPECT_GT(lines, 100);
  EXPECT_EQ(find(Vec<7>::Zero(), Vec<7>::Constant(0.04)).link, -1);
}

TEST(TouchPlace, OfATreeIsOnTheBranchThatIsTouched) {
  TreeModel<3>::Parameters p;
  p.joints[1].parent = p.joints[2].parent = 0;
  for (TreeJoint& j : p.joints) j.mass = 1;
  const TouchFinder<3> find(TreeModel<3>(p), Vec<3>::Constant(0.1));
  EXPECT_EQ(find(Vec<3>::Zero(), Vec<3>(5, 2, 0)).link, 1);
  EXPECT_EQ(find(Vec<3>::Zero(), Vec<3>(5, 0, 2)).link, 2);
  EXPECT_EQ(find(Vec<3>::Zero(), Vec<3>(2, 5, 0.05)).link, 1);
  EXPECT_EQ(find(Vec<3>::Zero(), Vec<3>(1, 0, 0)).link, 0);
}

}  // namespace
}  // namespace tauext::test
