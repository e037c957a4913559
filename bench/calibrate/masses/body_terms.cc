// SPDX-License-Identifier: Apache-2.0
#include "bench/calibrate/masses/body_terms.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cstddef>
#include <utility>

namespace tauext {
namespace {

using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

// of a unit mass at r
Matrix3d point_inertia(const Vector3d& r) {
  return r.squaredNorm() * Matrix3d::Identity() - r * r.transpose();
}

// velocities: of turning, and of the point at the origin of the frame
struct Velocity {
  Vector3d w = Vector3d::Zero(), v = Vector3d::Zero();
};
Velocity operator+(const Velocity& a, const Velocity& b) {
  return {a.w + b.w, a.v + b.v};
}
Velocity operator*(double x, const Velocity& a) {
  return {x * a.w, x * a.v};
}
Velocity cross(const Velocity& a, const Velocity& b) {
  return {a.w.cross(b.w), a.w.cross(b.v) + a.v.cross(b.w)};
}

// a body and what moves it, in the world's axes, about its origin
struct Moved {
  Matrix3d R;
  Vector3d p;
  Velocity V;
  std::vector<Velocity> S, Sd;  // of each coordinate
  // in the body's own axes, about its own origin
  Velocity own(const Velocity& m) const {
    return {R.transpose() * m.w, R.transpose() * (m.v + m.w.cross(p))};
  }
};

// what the numbers of a body multiply in w_j . L + v_j . l
Eigen::RowVectorXd momentum_row(const Velocity& j, const Velocity& V) {
  Eigen::RowVectorXd row(kBodyTerms);
  row[0] = j.v.dot(V.v);
  row.segment<3>(1) = (j.v.cross(V.w) + V.v.cross(j.w)).transpose();
  row.segment<3>(4) = j.w.cwiseProduct(V.w).transpose();
  row[7] = j.w[0] * V.w[1] + j.w[1] * V.w[0];
  row[8] = j.w[0] * V.w[2] + j.w[2] * V.w[0];
  row[9] = j.w[1] * V.w[2] + j.w[2] * V.w[1];
  return row;
}

}  // namespace

BodyVector body_vector(const TreeJoint& j) {
  const Matrix3d I = j.inertia + j.mass * point_inertia(j.center);
  BodyVector v;
  v << j.mass, j.mass * j.center, I(0, 0), I(1, 1), I(2, 2), I(0, 1), I(0, 2), I(1, 2);
  return v;
}

MeasuredBody body_of(const BodyVector& n, const Vector3d& origin) {
  const Vector3d c = n.segment<3>(1) / n[0];
  Matrix3d I;
  I << n[4], n[7], n[8], n[7], n[5], n[9], n[8], n[9], n[6];
  I -= n[0] * point_inertia(c);
  MeasuredBody b;
  b.mass = n[0];
  for (int i = 0; i < 3; ++i) b.center[i] = c[i] - origin[i];
  const double tensor[] = {I(0, 0), I(1, 1), I(2, 2), I(0, 1), I(0, 2), I(1, 2)};
  std::copy(std::begin(tensor), std::end(tensor), b.inertia);
  return b;
}

BodyTerms::BodyTerms(const ArmTree& arm, std::vector<int> bodies)
    : arm_(arm), bodies_(std::move(bodies)) {}

BodyTerms::At BodyTerms::at(const VectorXd& q, const VectorXd& qd) const {
  const auto n = static_cast<std::size_t>(arm_.dof());
  const VectorXd rho = arm_.drho * q + arm_.rho0, rate = arm_.drho * qd;
  std::vector<Moved> all;
  for (std::size_t i = 0; i < arm_.joints.size(); ++i) {
    const TreeJoint& j = arm_.joints[i];
    const bool slides = j.kind == TreeJoint::Kind::kSlide;
    const auto k = static_cast<Index>(i);
    const double moved = rho[k] - j.zero;
    Moved b = j.parent >= 0 ? all[static_cast<std::size_t>(j.parent)]
                            : Moved{Matrix3d::Identity(), Vector3d::Zero(), {}, {}, {}};
    b.S.resize(n), b.Sd.resize(n);
    b.p += b.R * j.position;
    b.R *= j.rotation;
    const Vector3d axis = b.R * j.axis.normalized();
    if (slides)
      b.p += moved * axis;
    else
      b.R *= Eigen::AngleAxisd(moved, j.axis.normalized()).toRotationMatrix();
    const Velocity S = slides ? Velocity{Vector3d::Zero(), axis} : Velocity{axis, b.p.cross(axis)};
    b.V = b.V + rate[k] * S;
    const Velocity Sd = cross(b.V, S);
    for (std::size_t c = 0; c < n; ++c) {
      const double share = arm_.drho(k, static_cast<Index>(c));
      b.S[c] = b.S[c] + share * S, b.Sd[c] = b.Sd[c] + share * Sd;
    }
    all.push_back(std::move(b));
  }
  At out{MatrixXd(arm_.dof(), columns()), MatrixXd(arm_.dof(), columns())};
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    const Moved& body = all[static_cast<std::size_t>(bodies_[b])];
    const Velocity V = body.own(body.V);
    const Vector3d g = body.R.transpose() * arm_.gravity;
    for (std::size_t c = 0; c < n; ++c) {
      const Velocity S = body.own(body.S[c]);
      Eigen::RowVectorXd bias = momentum_row(body.own(body.Sd[c]), V);
      bias[0] += S.v.dot(g);
      bias.segment<3>(1) += g.cross(S.w).transpose();
      const auto at = [&](MatrixXd& m) {
        return m.row(static_cast<Index>(c)).segment<kBodyTerms>(static_cast<Index>(b) * kBodyTerms);
      };
      at(out.momentum) = momentum_row(S, V);
      at(out.rest) = -bias;
    }
  }
  return out;
}

}  // namespace tauext
