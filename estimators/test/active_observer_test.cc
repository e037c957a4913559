// SPDX-License-Identifier: Apache-2.0
#include "estimators/active_observer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "estimators/test/arm.h"
#include "estimators/testbed1.h"

namespace tauext::test {
namespace {

template <class Arm>
ActiveObserver<Arm> aob(double w, const Arm& arm = Arm()) {
  return ActiveObserver<Arm>(arm, ActiveObserver<Arm>::Parameters::for_bandwidth(arm, w));
}

// (ii) and (iii) for one joint held at q = 0 as a textbook has them: dense, Q by quadrature
class TextbookJoint {
 public:
  explicit TextbookJoint(const Mat<3>& P0) : P(P0) {}

  void step(double h, double a, const ActiveObserver<Testbed1>::Parameters& p) {
    const Mat<3> Phi = transition(h);
    Mat<3> Q = Mat<3>::Zero();
    constexpr int kPieces = 1000;
    for (int i = 0; i < kPieces; ++i) {
      const Mat<3> T = transition(h * (i + 0.5) / kPieces);
      Q += h / kPieces * T * Vec<3>(0, p.Q_qdd, p.Q_delta).asDiagonal() * T.transpose();
    }
    x = Phi * x + Vec<3>(0.5 * h * h * a, h * a, 0);
    P = Mat<3>(Phi * P * Phi.transpose()) + Q;
    for (int i = 0; i < 2; ++i) {  // q and qd are measured as 0
      const Vec<3> c = P.col(i);
      const double s = P(i, i) + (i == 0 ? p.R_q : p.R_qd) / h;
      x -= c / s * x[i];
      P -= c * c.transpose() / s;
    }
  }

  Vec<3> x = Vec<3>::Zero();
  Mat<3> P;

 private:
  static Mat<3> transition(double h) {
    return (Mat<3>() << 1, h, -h * h / 2, 0, 1, -h, 0, 0, 1).finished();
  }
};

TEST(Aob, AgreesWithTheDenseTextbookFilter) {
  const Testbed1 arm;
  const auto p = ActiveObserver<Testbed1>::Parameters::for_bandwidth(arm, 30);
  ActiveObserver<Testbed1> filter(arm, p);
  Measurement<1> y;
  y.tau = arm.gravity(y.q) + Vec<1>(5);
  filter.update(y);
  TextbookJoint textbook(filter.covariance());
  for (int k = 1; k < 300; ++k) {
    const double h = 1e-3 * (1 + k % 3);
    y.t += h;
    const double d = filter.update(y).tau_ext[0];
    textbook.step(h, 5 / arm.parameters().theta1, p);
    ASSERT_NEAR(d, arm.parameters().theta1 * textbook.x[2], 1e-6) << "k = " << k;
    ASSERT_LT((filter.covariance() - textbook.P).norm(), 1e-6 * textbook.P.norm());
  }
}

TEST(Aob, PassesASineAtItsBandwidthAtAbout3dB) {
  Testbed1::Parameters smooth;
  smooth.theta4 = 0;
  const Testbed1 arm(smooth);
  for (const double w : {10., 30., 100., 300.}) {
    auto filter = aob(w, arm);
    const auto sine = [=](double t) -> Vec<1> { return Vec<1>(5 * std::sin(w * t)); };
    double a = 0, b = 0;
    const double from = 2 * M_PI / w * 4, to = 2 * M_PI / w * 8;
    for (const auto& y : simulate<Testbed1>(grid(to, 0.25e-3), sine, {}, arm)) {
      if (const double d = filter.update(y).tau_ext[0]; y.t >= from) {
        a += d * std::cos(w * y.t), b += d * std::sin(w * y.t);
      }
    }
    const double gain = std::hypot(a, b) * 0.25e-3 * 2 / (to - from) / 5;
    EXPECT_NEAR(gain, std::sqrt(0.5), 0.1) << "w = " << w << ": exact for each noise alone";
  }
}

TEST(Aob, EveryJointRespondsAlikeWhereverTheyAre) {
  // coupled joints, one filter: the shapes of their steps are one
  const WallMoBot3 arm;
  auto filter = aob<WallMoBot3>(30);
  const Vec<3> load(50, -20, 30);
  Measurement<3> y;
  y.q << 0.4, -0.3, 0.8;
  for (int k = 0; k < 400; ++k) {
    y.t = k * 1e-3;
    y.tau = arm.gravity(y.q) + load;
    const Vec<3> share = filter.update(y).tau_ext.cwiseQuotient(load);
    ASSERT_LT((share - share[0] * Vec<3>::Ones()).norm(), 1e-9);
  }
}

TEST(Aob, StartedInMotionItIsRightFromTheFirstSample) {
  auto filter = aob<WallMoBot3>(30);
  double worst = 0;
  for (const auto& y : simulate(grid(5, 1e-3), constant(0), {.amplitude = 0.3, .w = 2})) {
    worst = std::max(worst, filter.update(y).tau_ext.cwiseAbs().maxCoeff());
  }
  EXPECT_LT(worst, 0.01) << "N m";
}

TEST(Aob, RefusesDensitiesThatMeanNothing) {
  EXPECT_THROW(aob<WallMoBot3>(0), std::invalid_argument);
  EXPECT_THROW(ActiveObserver<WallMoBot3>(WallMoBot3(), {.R_q = 0}), std::invalid_argument);
}

}  // namespace
}  // namespace tauext::test
