// SPDX-License-Identifier: Apache-2.0
/// @file
/// The sums over the bodies of a tree from which tree_model.h takes its terms; its equations (i) to
/// (iv) are meant here.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstddef>

#include "estimators/math/sin_cos.h"
#include "estimators/tree/each.h"
#include "estimators/tree/tree_joint.h"

namespace tauext::detail {

/// Of N joints; rho [rad] and its rate are those of the joints themselves.
template <int N, class Scalar>
class TreePasses {
 public:
  static constexpr int P = kPadded<N>;  ///< lanes
  using VecN = Vec<N, Scalar>;          ///< a number of each joint
  using MatN = Mat<N, Scalar>;          ///< over the joints
  using Square = Mat<P, Scalar>;        ///< the same in lanes
  using One = Each<P, Scalar>;          ///< the same in lanes
  using Three = Each3<P, Scalar>;       ///< vectors
  using Motion = EachMotion<P, Scalar>;
  using Force = EachForce<P, Scalar>;
  using Inertia = EachInertia<P, Scalar>;

  /// Where the bodies are.
  struct Pose {
    Each33<P, Scalar> R;  ///< [1] their axes in those of the base
    Three p;              ///< [m] their origins
    Motion S;             ///< the joints' axes
    Inertia I;            ///< of each body alone
  };
  /// How they move.
  struct Flow {
    Motion V, Sd, A;  ///< of (i)
    Force H, F;       ///< momentum of each body alone, and what moves it so
  };

  TreePasses(const std::array<TreeJoint, N>& joints, const Vec<3>& gravity) {
    g_.x = One::all(Scalar(gravity[0]));
    g_.y = One::all(Scalar(gravity[1]));
    g_.z = One::all(Scalar(gravity[2]));
    for (int i = 0; i < N; ++i) behind_[i] = own_behind_[i] = ahead_[i] = One::zero();
    for (int i = 0; i < N; ++i) fill(joints, i);
  }

  /// At rho.
  [[gnu::always_inline]] Pose pose(const VecN& rho) const noexcept {
    const VecN moved = rho - zero_;
    VecN s, c;
    tauext::sin_cos<N>(VecN(moved.cwiseProduct(turns_)), s, c);
    const One sine = One::from(s), cosine = One::from(c), slide = slide_ * One::from(moved);
    const Each33<P, Scalar> turn{cosine * R_.x + sine * R_.y, cosine * R_.y - sine * R_.x, R_.z};
    Pose out = placed(turn, p_ + slide * R_.z);
    out.S = {hinge_ * out.R.z, hinge_ * cross(out.p, out.R.z) + slide_ * out.R.z};
    const Three c_w = out.p + out.R * center_, mc = m_ * c_w;
    const Each33<P, Scalar> T{out.R * Sigma_.x, out.R * Sigma_.y, out.R * Sigma_.z};
    out.I = {m_,
             mc,
             {mc.x * c_w + out.R.x.x * T.x + out.R.y.x * T.y + out.R.z.x * T.z,
              mc.y * c_w + out.R.x.y * T.x + out.R.y.y * T.y + out.R.z.y * T.z,
              mc.z * c_w + out.R.x.z * T.x + out.R.y.z * T.y + out.R.z.z * T.z}};
    return out;
  }

  /// At that rate, without acceleration of the joints.
  [[gnu::always_inline]] Flow flow(const Pose& s, const VecN& rate) const noexcept {
    const One qd = One::from(rate);
    Flow f;
    f.V = from_base(qd * s.S);
    f.Sd = cross(f.V, s.S);
    f.A = from_base(qd * f.Sd);
    f.A.v = f.A.v - g_;
    f.H = s.I * f.V;
    f.F = s.I * f.A + cross(f.V, f.H);
    return f;
  }

  /// The same with acceleration.
  [[gnu::always_inline]] void accelerate(const Pose& s, const VecN& acceleration,
                                         Flow& f) const noexcept {
    f.A = f.A + from_base(One::from(acceleration) * s.S);
    f.F = s.I * f.A + cross(f.V, f.H);
  }

  /// The inertias of the subtrees.
  [[gnu::always_inline]] Inertia composite(const Inertia& I) const noexcept {
    const Three x = subtree(I.Sigma.x);
    const One yy = subtree(I.Sigma.y.y), yz = subtree(I.Sigma.y.z), zz = subtree(I.Sigma.z.z);
    return {m_behind_, subtree(I.h), {x, {x.y, yy, yz}, {x.z, yz, zz}}};
  }

  [[gnu::always_inline]] Force subtree(const Force& f) const noexcept {
    return {subtree(f.n), subtree(f.f)};
  }

  /// S . F of each joint.
  [[gnu::always_inline]] static VecN along(const Motion& S, const Force& F) noexcept {
    const One power = dot(S, F);
    VecN out;
    for (int i = 0; i < N; ++i) out[i] = power[i];
    return out;
  }

  /// B of (ii), with the rotors.
  [[gnu::always_inline]] Square inertia(const Pose& s, const Inertia& c) const noexcept {
    const Force IS = c * s.S;
    Square B, lower;
    B.template rightCols<P - N>().setZero();
    lower.template rightCols<P - N>().setZero();
#pragma GCC unroll 8
    for (int i = 0; i < N; ++i) {
      const One column = dot(s.S.of(i), IS);
      (armature_[i] + behind_[i] * column).since(i).store(&B(0, i));
      (own_behind_[i] * column).since(i).store(&lower(0, i));
    }
    B += transposed(lower);
    return B;
  }

  /// -g, the moment of the weights.
  [[gnu::always_inline]] VecN weights(const Pose& s, const Inertia& c) const noexcept {
    return along(s.S, {cross(c.h, g_), c.m * g_});
  }

  /// The transposes of d tau/d rho and d tau/d rate of (iv), for the flow with its acceleration.
  [[gnu::always_inline]] void derivatives(const Pose& s, const Flow& f, const Inertia& c,
                                          Square& by_q, Square& by_qd) const noexcept {
    const Motion Sdd = cross(f.A, s.S) + cross(f.V, f.Sd);
    const Each33<P, Scalar> Y{subtree(s.I.h.x * f.V.v + cross(f.V.w, s.I.Sigma.x)),
                              subtree(s.I.h.y * f.V.v + cross(f.V.w, s.I.Sigma.y)),
                              subtree(s.I.h.z * f.V.v + cross(f.V.w, s.I.Sigma.z))};
    const Three l = subtree(f.H.f);
    const One two = One::all(Scalar(2)), trace = Y.x.x + Y.y.y + Y.z.z;
    const auto twice_B = [&](const Motion& x) {  // (iii)
      return Force{two * (trace * x.w - Y * x.w), two * cross(x.w, l)};
    };
    const Force IS = c * s.S, ISd = c * f.Sd;
    const Three BtS = two * (trace * s.S.w - Y.transposed_times(s.S.w) + cross(l, s.S.v));
    const Force q_above = twice_B(f.Sd) + c * Sdd + cross(s.S, subtree(f.F));
    const Force qd_above = twice_B(s.S) + two * ISd;
    Square q_columns, qd_columns;  // below the diagonal
    for (Square* m : {&by_q, &by_qd, &q_columns, &qd_columns})
      m->template rightCols<P - N>().setZero();
    for_each<(P > 4), N>([&](int i) __attribute__((always_inline)) {
      const Motion S = s.S.of(i), Sd = f.Sd.of(i);
      const One q_below = dot(BtS, Sd.w) + dot(Sdd.of(i), IS);
      const One qd_below = dot(BtS, S.w) + two * dot(Sd, IS);
      const One q_right = dot(S, q_above), qd_right = dot(S, qd_above);
      (behind_[i] * q_right).store(&by_q(0, i));
      (behind_[i] * qd_right).store(&by_qd(0, i));
      (own_behind_[i] * q_below).store(&q_columns(0, i));
      (own_behind_[i] * qd_below).store(&qd_columns(0, i));
    });
    by_q += transposed(q_columns);
    by_qd += transposed(qd_columns);
  }

  /// 1 for the joints on the way to joint j, and itself.
  const One& ahead(int j) const noexcept {
    return ahead_[j];
  }

  /// A point [m] in the frame that joint j was given with, in the axes of the base.
  Vec<3, Scalar> at_base(const Pose& s, int j, const Vec<3>& point) const noexcept {
    const Vec<3, Scalar> local = (to_own_[j] * point).template cast<Scalar>();
    const auto component = [&](const One& p, const One& x, const One& y, const One& z) {
      return p[j] + x[j] * local[0] + y[j] * local[1] + z[j] * local[2];
    };
    return {component(s.p.x, s.R.x.x, s.R.y.x, s.R.z.x),
            component(s.p.y, s.R.x.y, s.R.y.y, s.R.z.y),
            component(s.p.z, s.R.x.z, s.R.y.z, s.R.z.z)};
  }

 private:
  void fill(const std::array<TreeJoint, N>& joints, int i);

  // from each body's frame in its parent's to all in the base's
  [[gnu::always_inline]] Pose placed(const Each33<P, Scalar>& R, const Three& p) const noexcept {
    using Four = Each<4, Scalar>;  // x, y and z of one body, and nothing
    Four x[P + 1], y[P + 1], z[P + 1], at[P + 1];
    x[0] = y[0] = z[0] = at[0] = Four::zero();
    x[0].set(0, Scalar(1)), y[0].set(1, Scalar(1)), z[0].set(2, Scalar(1));
#pragma GCC unroll 8
    for (int i = 0; i < N; ++i) {
      const int parent = parent_[i] + 1;
      const auto turned = [&](const Three& v) {
        return Four::all(v.x[i]) * x[parent] + Four::all(v.y[i]) * y[parent] +
               Four::all(v.z[i]) * z[parent];
      };
      x[i + 1] = turned(R.x), y[i + 1] = turned(R.y), z[i + 1] = turned(R.z);
      at[i + 1] = at[parent] + turned(p);
    }
#pragma GCC unroll 8
    for (int i = N + 1; i <= P; ++i) x[i] = y[i] = z[i] = at[i] = Four::zero();
    Pose out;
    out.R.x.set_all(x + 1), out.R.y.set_all(y + 1), out.R.z.set_all(z + 1), out.p.set_all(at + 1);
    return out;
  }

  // sums over the way from the base, and over the subtrees
  [[gnu::always_inline]] One from_base(const One& x) const noexcept {
    One sum = One::zero();
#pragma GCC unroll 8
    for (int i = 0; i < N; ++i) sum.add(behind_[i], x[i], i, P - 1);
    return sum;
  }
  [[gnu::always_inline]] Motion from_base(const Motion& m) const noexcept {
    return {{from_base(m.w.x), from_base(m.w.y), from_base(m.w.z)},
            {from_base(m.v.x), from_base(m.v.y), from_base(m.v.z)}};
  }
  [[gnu::always_inline]] One subtree(const One& x) const noexcept {
    One sum = One::zero();
#pragma GCC unroll 8
    for (int i = 0; i < N; ++i) sum.add(ahead_[i], x[i], 0, i);
    return sum;
  }
  [[gnu::always_inline]] Three subtree(const Three& v) const noexcept {
    return {subtree(v.x), subtree(v.y), subtree(v.z)};
  }

  int parent_[N];
  Mat<3> to_own_[N];          // from the frame of the TreeJoint to ours, z along the axis
  One behind_[N], ahead_[N];  // [i][j]: 1 if j is in i's subtree, or i in j's
  One own_behind_[N];         // behind_ without i itself
  VecN zero_, turns_;         // [rad] rho of the pose below; 1 of hinges
  One armature_[N];           // [kg m^2] of i, and 0 of the others
  One hinge_ = One::zero(), slide_ = hinge_, m_ = hinge_, m_behind_ = hinge_;
  Each33<P, Scalar> R_, Sigma_;  // in the parent's axes; about the center of mass, in ours
  Three p_, center_, g_;         // [m] in the parent's axes, in ours; [m/s^2] gravity
};

template <int N, class Scalar>
void TreePasses<N, Scalar>::fill(const std::array<TreeJoint, N>& joints, int i) {
  const TreeJoint& j = joints[static_cast<std::size_t>(i)];
  check_joint(j, i);
  // own axes: z along the joint's
  const Vec<3> z = j.axis.normalized(), x = z.unitOrthogonal();
  Mat<3> own;
  own << x, z.cross(x), z;
  to_own_[i] = own.transpose();
  Mat<3> in_parent = j.rotation * own;
  Vec<3> at = j.position;
  if (j.parent >= 0) {
    const Mat<3>& of_parent = to_own_[j.parent];
    in_parent = of_parent * in_parent;
    at = of_parent * at;
  }
  R_.x.set(i, in_parent.col(0).template cast<Scalar>());
  R_.y.set(i, in_parent.col(1).template cast<Scalar>());
  R_.z.set(i, in_parent.col(2).template cast<Scalar>());
  p_.set(i, at.template cast<Scalar>());
  center_.set(i, (own.transpose() * j.center).template cast<Scalar>());
  // the second moment that has this inertia: tr(Sigma) 1 - Sigma
  const Mat<3> turned = own.transpose() * j.inertia * own;
  const Mat<3> Sigma = 0.5 * turned.trace() * Mat<3>::Identity() - turned;
  Sigma_.x.set(i, Sigma.col(0).template cast<Scalar>());
  Sigma_.y.set(i, Sigma.col(1).template cast<Scalar>());
  Sigma_.z.set(i, Sigma.col(2).template cast<Scalar>());
  const bool hinge = j.kind == TreeJoint::Kind::kHinge;
  zero_[i] = Scalar(j.zero);
  turns_[i] = Scalar(hinge ? 1 : 0);
  hinge_.set(i, Scalar(hinge ? 1 : 0));
  slide_.set(i, Scalar(hinge ? 0 : 1));
  armature_[i] = One::zero();
  armature_[i].set(i, Scalar(j.armature));
  m_.set(i, Scalar(j.mass));
  parent_[i] = j.parent;
  for (int k = i; k >= 0; k = parent_[k]) {
    behind_[k].set(i, Scalar(1));
    own_behind_[k].set(i, Scalar(k == i ? 0 : 1));
    ahead_[i].set(k, Scalar(1));
    m_behind_.set(k, m_behind_[k] + m_[i]);
  }
}

}  // namespace tauext::detail
