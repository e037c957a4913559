// SPDX-License-Identifier: Apache-2.0
/// @file
/// The sums over the bodies of a tree from which tree_model.h takes its terms; its equations (i) to
/// (iv) are meant here.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstddef>

#include "estimators/math/block.h"
#include "estimators/math/sin_cos.h"
#include "estimators/tree/tree_joint.h"
#include "estimators/tree/tree_sums.h"

namespace tauext::detail {

/// Of N joints; rho [rad] and its rate are those of the joints themselves. kApart is that of
/// for_pieces(): whether the caller does so much that pieces should be functions of their own.
template <int N, class Scalar>
class TreePasses {
 public:
  static constexpr int P = kPadded<N, Scalar>;  ///< lanes
  using VecN = Vec<N, Scalar>;                  ///< a number of each joint
  using MatN = Mat<N, Scalar>;                  ///< over the joints
  using Square = Block<N, Scalar>;              ///< the same in lanes
  using One = Each<P, Scalar>;                  ///< the same in lanes
  using Three = Each3<P, Scalar>;               ///< vectors
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
    for (int i = 0; i < N; ++i) fill(joints, i);
    m_behind_ = sums_.subtree(m_);
  }

  /// At rho.
  template <bool kApart = false>
  [[gnu::always_inline]] Pose pose(const VecN& rho) const noexcept {
    const VecN moved = rho - zero_;
    VecN s, c;
    using tauext::sin_cos;  // a scalar may have its own: pack.h
    sin_cos<N>(VecN(moved.cwiseProduct(turns_)), s, c);
    const One sine = One::from(s), cosine = One::from(c), slide = slide_ * One::from(moved);
    Pose out;
    out.R = {cosine * R_.x + sine * R_.y, cosine * R_.y - sine * R_.x, R_.z};
    out.p = p_ + slide * R_.z;
    sums_.place(out.R, out.p);
    for_pieces<P, Scalar, kApart>([&](int k) __attribute__((always_inline)) {
      const auto R = out.R.piece(k), Sigma = Sigma_.piece(k);
      const auto p = out.p.piece(k);
      const auto hinge = hinge_.piece(k), m = m_.piece(k);
      out.S.put(k, {hinge * R.z, hinge * cross(p, R.z) + slide_.piece(k) * R.z});
      const auto at = p + R * center_.piece(k), mc = m * at;
      const typename Each33<P, Scalar>::Piece T{R * Sigma.x, R * Sigma.y, R * Sigma.z};
      const auto x = mc.x * at + R.x.x * T.x + R.y.x * T.y + R.z.x * T.z;
      const auto yy = mc.y * at.y + R.x.y * T.x.y + R.y.y * T.y.y + R.z.y * T.z.y,
                 yz = mc.y * at.z + R.x.y * T.x.z + R.y.y * T.y.z + R.z.y * T.z.z,
                 zz = mc.z * at.z + R.x.z * T.x.z + R.y.z * T.y.z + R.z.z * T.z.z;
      out.I.put(k, {m, mc, {x, {x.y, yy, yz}, {x.z, yz, zz}}});
    });
    return out;
  }

  /// At that rate, without acceleration of the joints.
  template <bool kApart = false>
  [[gnu::always_inline]] Flow flow(const Pose& s, const VecN& rate) const noexcept {
    const One qd = One::from(rate);
    Flow f;
    f.V = sums_.from_base(qd * s.S);
    for_pieces<P, Scalar, kApart>([&](int k) __attribute__((always_inline)) {
      const auto V = f.V.piece(k), Sd = cross(V, s.S.piece(k));
      f.Sd.put(k, Sd);
      f.A.put(k, qd.piece(k) * Sd);
      f.H.put(k, s.I.piece(k) * V);
    });
    f.A = sums_.from_base(f.A);
    f.A.v = f.A.v - g_;
    for_pieces<P, Scalar, kApart>([&](int k) __attribute__((always_inline)) {
      f.F.put(k, s.I.piece(k) * f.A.piece(k) + cross(f.V.piece(k), f.H.piece(k)));
    });
    return f;
  }

  /// The same with acceleration.
  template <bool kApart>
  [[gnu::always_inline]] void accelerate(const Pose& s, const VecN& acceleration,
                                         Flow& f) const noexcept {
    const Motion more = sums_.from_base(One::from(acceleration) * s.S);
    f.A = f.A + more;
    for_pieces<P, Scalar, kApart>([&](int k) __attribute__((always_inline)) {
      f.F.put(k, f.F.piece(k) + s.I.piece(k) * more.piece(k));
    });
  }

  const TreeSums<N, Scalar>& sums() const noexcept { return sums_; }  ///< the tree's order

  /// The inertias of the subtrees.
  [[gnu::always_inline]] Inertia composite(const Inertia& I) const noexcept {
    const Three x = sums_.subtree(I.Sigma.x);
    const One yy = sums_.subtree(I.Sigma.y.y), yz = sums_.subtree(I.Sigma.y.z),
              zz = sums_.subtree(I.Sigma.z.z);
    return {m_behind_, sums_.subtree(I.h), {x, {x.y, yy, yz}, {x.z, yz, zz}}};
  }

  /// S . F of each joint.
  [[gnu::always_inline]] static VecN along(const Motion& S, const Force& F) noexcept {
    const One power = dot(S, F);
    VecN out;
    for (int i = 0; i < N; ++i) out[i] = power[i];
    return out;
  }

  /// I^c S of each joint.
  template <bool kApart = false>
  [[gnu::always_inline]] static Force momenta(const Pose& s, const Inertia& c) noexcept {
    Force IS;
    for_pieces<P, Scalar, kApart>([&](int k) __attribute__((always_inline)) {
      IS.put(k, c.piece(k) * s.S.piece(k));
    });
    return IS;
  }

  /// B of (ii), with the rotors, from the momenta.
  [[gnu::always_inline]] Square inertia(const Pose& s, const Force& IS) const noexcept {
    if constexpr (TreeSums<N, Scalar>::kInLanes) {
      Square B, lower;
#pragma GCC unroll 8
      for (int i = 0; i < N; ++i) {
        const One column = dot(s.S.of(i), IS);
        B.column[i] = (armature_[i] + sums_.behind(i) * column).since(i);
        lower.column[i] = (sums_.strictly_behind(i) * column).since(i);
      }
      B.add(transposed(lower));
      return B;
    } else {
      Square B = Square::zero();
      for (int j = 0; j < N; ++j) {
        const auto momentum = IS.piece(j);
        for (int i = j; i >= 0; i = sums_.parent(i)) {
          const Scalar both = dot(s.S.piece(i), momentum)[0];
          B.column[i].set(j, both);
          B.column[j].set(i, both);
        }
        B.column[j].set(j, B(j, j) + armature_[j][j]);
      }
      return B;
    }
  }

  /// -g, the moment of the weights.
  [[gnu::always_inline]] VecN weights(const Pose& s, const Inertia& c) const noexcept {
    return along(s.S, {cross(c.h, g_), c.m * g_});
  }

  /// d tau/d rho and d tau/d rate of (iv), for the flow with its acceleration.
  template <bool kApart>
  [[gnu::always_inline]] void derivatives(const Pose& s, const Flow& f, const Inertia& c,
                                          const Force& IS, Square& by_q,
                                          Square& by_qd) const noexcept {
    Motion Sdd;
    Each33<P, Scalar> Y;
    for_pieces<P, Scalar, kApart>([&](int k) __attribute__((always_inline)) {
      const auto V = f.V.piece(k);
      Sdd.put(k, cross(f.A.piece(k), s.S.piece(k)) + cross(V, f.Sd.piece(k)));
      const auto I = s.I.piece(k);
      Y.x.put(k, I.h.x * V.v + cross(V.w, I.Sigma.x));
      Y.y.put(k, I.h.y * V.v + cross(V.w, I.Sigma.y));
      Y.z.put(k, I.h.z * V.v + cross(V.w, I.Sigma.z));
    });
    Y = {sums_.subtree(Y.x), sums_.subtree(Y.y), sums_.subtree(Y.z)};
    const Three l = sums_.subtree(f.H.f);
    const Force F = sums_.subtree(f.F);
    const One two = One::all(Scalar(2));
    Three BtS;
    Force q_above, qd_above;
    for_pieces<P, Scalar, kApart>([&](int k) __attribute__((always_inline)) {
      const auto Y_c = Y.piece(k);
      const auto l_c = l.piece(k);
      const auto I_c = c.piece(k);
      const auto S = s.S.piece(k), Sd = f.Sd.piece(k);
      const auto two_c = two.piece(k), trace = Y_c.x.x + Y_c.y.y + Y_c.z.z;
      const auto twice_B = [&](const auto& x) __attribute__((always_inline)) {  // (iii)
        return typename Force::Piece{two_c * (trace * x.w - Y_c * x.w), two_c * cross(x.w, l_c)};
      };
      BtS.put(k, two_c * (trace * S.w - Y_c.transposed_times(S.w) + cross(l_c, S.v)));
      q_above.put(k, twice_B(Sd) + I_c * Sdd.piece(k) + cross(S, F.piece(k)));
      qd_above.put(k, twice_B(S) + two_c * (I_c * Sd));
    });
    Square q_rows, qd_rows;  // on and right of the diagonal
    for_each<(P > 4), N>([&](int i) __attribute__((always_inline)) {
      const Motion S = s.S.of(i), Sd = f.Sd.of(i);
      const One q_below = dot(BtS, Sd.w) + dot(Sdd.of(i), IS);
      const One qd_below = dot(BtS, S.w) + two * dot(Sd, IS);
      const One q_right = dot(S, q_above), qd_right = dot(S, qd_above);
      q_rows.column[i] = sums_.behind(i) * q_right;
      qd_rows.column[i] = sums_.behind(i) * qd_right;
      by_q.column[i] = sums_.strictly_behind(i) * q_below;
      by_qd.column[i] = sums_.strictly_behind(i) * qd_below;
    });
    by_q.add(transposed(q_rows));
    by_qd.add(transposed(qd_rows));
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

  TreeSums<N, Scalar> sums_;
  Mat<3> to_own_[N];   // from the frame of the TreeJoint to ours, z along the axis
  VecN zero_, turns_;  // [rad] rho of the pose below; 1 of hinges
  One armature_[N];    // [kg m^2] of i, and 0 of the others
  One hinge_ = One::zero(), slide_ = hinge_, m_ = hinge_, m_behind_;
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
  sums_.add(i, j.parent);
}

}  // namespace tauext::detail
