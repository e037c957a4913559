// SPDX-License-Identifier: Apache-2.0
/// @file
/// A vector, a spatial vector or an inertia of each body of an arm.
///
/// Spatial vectors (Featherstone, Rigid Body Dynamics Algorithms) are in the world's axes and about
/// the origin of the world. A motion (w; v) turns by w, and moves the body's point that is at the
/// origin by v. A force (n; f) has the moment n about the origin.
#pragma once

#include <type_traits>

#include "estimators/math/each.h"

namespace tauext::detail {

/// A vector of each.
template <int P, class Scalar>
struct Each3 {
  using One = Each<P, Scalar>;                            ///< a component of each
  One x = One::zero(), y = One::zero(), z = One::zero();  ///< components

  using Piece = Each3<kPiece<P, Scalar>, Scalar>;  ///< the vectors of a piece
  [[gnu::always_inline]] Piece piece(int k) const noexcept {
    return {x.piece(k), y.piece(k), z.piece(k)};
  }
  [[gnu::always_inline]] void put(int k, const Piece& p) noexcept {
    x.put(k, p.x), y.put(k, p.y), z.put(k, p.z);
  }

  /// Sets that of body i.
  template <class V>
  [[gnu::always_inline]] void set(int i, const V& v) noexcept {
    x.set(i, v[0]), y.set(i, v[1]), z.set(i, v[2]);
  }
  /// That of body i, as if every body had it.
  [[gnu::always_inline]] Each3 of(int i) const noexcept {
    return {One::all(x[i]), One::all(y[i]), One::all(z[i])};
  }
  /// Sets all of them from `own`, of which each has (x, y, z) of one body.
  [[gnu::always_inline]] void set_all(const Each<4, Scalar>* own) noexcept {
    if constexpr (P % 4 == 0) {
#pragma GCC unroll 4
      for (int k = 0; k < P / 4; ++k) {
        Lanes none = own[4 * k + 3].x[0];
        x.x[k] = own[4 * k].x[0], y.x[k] = own[4 * k + 1].x[0], z.x[k] = own[4 * k + 2].x[0];
        turn(x.x[k], y.x[k], z.x[k], none);
      }
    } else {
      for (int i = 0; i < P; ++i) set(i, own[i]);
    }
  }
};

template <int P, class S>
[[gnu::always_inline]] inline Each3<P, S> operator+(const Each3<P, S>& a,
                                                    const Each3<P, S>& b) noexcept {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
template <int P, class S>
[[gnu::always_inline]] inline Each3<P, S> operator-(const Each3<P, S>& a,
                                                    const Each3<P, S>& b) noexcept {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
template <int P, class S>
[[gnu::always_inline]] inline Each3<P, S> operator*(const Each<P, S>& a,
                                                    const Each3<P, S>& b) noexcept {
  return {a * b.x, a * b.y, a * b.z};
}
template <int P, class S>
[[gnu::always_inline]] inline Each<P, S> dot(const Each3<P, S>& a, const Each3<P, S>& b) noexcept {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <int P, class S>
[[gnu::always_inline]] inline Each3<P, S> cross(const Each3<P, S>& a,
                                                const Each3<P, S>& b) noexcept {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/// A 3 x 3 matrix of each, by columns.
template <int P, class Scalar>
struct Each33 {
  Each3<P, Scalar> x, y, z;  ///< columns

  using Piece = Each33<kPiece<P, Scalar>, Scalar>;  ///< the matrices of a piece
  [[gnu::always_inline]] Piece piece(int k) const noexcept {
    return {x.piece(k), y.piece(k), z.piece(k)};
  }

  [[gnu::always_inline]] Each3<P, Scalar> operator*(
      const Each3<P, Scalar>& v) const noexcept {  ///< times a vector
    return v.x * x + v.y * y + v.z * z;
  }
  /// Its transpose times a vector.
  [[gnu::always_inline]] Each3<P, Scalar> transposed_times(
      const Each3<P, Scalar>& v) const noexcept {
    return {dot(x, v), dot(y, v), dot(z, v)};
  }
};

/// A motion (w; v) of each.
template <int P, class Scalar>
struct EachMotion {
  Each3<P, Scalar> w, v;  ///< [rad/s], [m/s]

  using Piece = EachMotion<kPiece<P, Scalar>, Scalar>;  ///< the motions of a piece
  [[gnu::always_inline]] Piece piece(int k) const noexcept { return {w.piece(k), v.piece(k)}; }
  [[gnu::always_inline]] void put(int k, const Piece& p) noexcept { w.put(k, p.w), v.put(k, p.v); }

  /// That of body i, as if every body had it.
  [[gnu::always_inline]] EachMotion of(int i) const noexcept { return {w.of(i), v.of(i)}; }
};
template <int P, class S>
[[gnu::always_inline]] inline EachMotion<P, S> operator+(const EachMotion<P, S>& a,
                                                         const EachMotion<P, S>& b) noexcept {
  return {a.w + b.w, a.v + b.v};
}
template <int P, class S>
[[gnu::always_inline]] inline EachMotion<P, S> operator*(const Each<P, S>& a,
                                                         const EachMotion<P, S>& b) noexcept {
  return {a * b.w, a * b.v};
}
/// How b changes if it moves along with a.
template <int P, class S>
[[gnu::always_inline]] inline EachMotion<P, S> cross(const EachMotion<P, S>& a,
                                                     const EachMotion<P, S>& b) noexcept {
  return {cross(a.w, b.w), cross(a.w, b.v) + cross(a.v, b.w)};
}

/// A force (n; f), or a momentum, of each.
template <int P, class Scalar>
struct EachForce {
  Each3<P, Scalar> n, f;  ///< [N m], [N]

  using Piece = EachForce<kPiece<P, Scalar>, Scalar>;  ///< the forces of a piece
  [[gnu::always_inline]] Piece piece(int k) const noexcept { return {n.piece(k), f.piece(k)}; }
  [[gnu::always_inline]] void put(int k, const Piece& p) noexcept { n.put(k, p.n), f.put(k, p.f); }

  /// That of body i, as if every body had it.
  [[gnu::always_inline]] EachForce of(int i) const noexcept { return {n.of(i), f.of(i)}; }
};
template <int P, class S>
[[gnu::always_inline]] inline EachForce<P, S> operator+(const EachForce<P, S>& a,
                                                        const EachForce<P, S>& b) noexcept {
  return {a.n + b.n, a.f + b.f};
}
template <int P, class S>
[[gnu::always_inline]] inline EachForce<P, S> operator*(const Each<P, S>& a,
                                                        const EachForce<P, S>& b) noexcept {
  return {a * b.n, a * b.f};
}
template <int P, class S>
[[gnu::always_inline]] inline Each<P, S> dot(const EachMotion<P, S>& a,
                                             const EachForce<P, S>& b) noexcept {
  return dot(a.w, b.n) + dot(a.v, b.f);
}
/// How b changes if it moves along with a.
template <int P, class S>
[[gnu::always_inline]] inline EachForce<P, S> cross(const EachMotion<P, S>& a,
                                                    const EachForce<P, S>& b) noexcept {
  return {cross(a.w, b.n) + cross(a.v, b.f), cross(a.w, b.f)};
}

/// The inertia of each: mass, first and second moment about the origin.
template <int P, class Scalar>
struct EachInertia {
  Each<P, Scalar> m = Each<P, Scalar>::zero();  ///< [kg]
  Each3<P, Scalar> h;                           ///< [kg m] integral of r dm
  Each33<P, Scalar> Sigma;                      ///< [kg m^2] integral of r r^T dm

  using Piece = EachInertia<kPiece<P, Scalar>, Scalar>;  ///< the inertias of a piece
  [[gnu::always_inline]] Piece piece(int k) const noexcept {
    return {m.piece(k), h.piece(k), Sigma.piece(k)};
  }
  [[gnu::always_inline]] void put(int k, const Piece& p) noexcept {
    m.put(k, p.m), h.put(k, p.h);
    Sigma.x.put(k, p.Sigma.x), Sigma.y.put(k, p.Sigma.y), Sigma.z.put(k, p.Sigma.z);
  }

  /// What it takes to move so: (tr(Sigma) w - Sigma w + h x v; m v - h x w).
  [[gnu::always_inline]] EachForce<P, Scalar> operator*(
      const EachMotion<P, Scalar>& a) const noexcept {
    const Each<P, Scalar> trace = Sigma.x.x + Sigma.y.y + Sigma.z.z;
    return {trace * a.w - Sigma * a.w + cross(h, a.v), m * a.v - cross(h, a.w)};
  }
};

}  // namespace tauext::detail
