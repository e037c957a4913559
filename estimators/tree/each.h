// SPDX-License-Identifier: Apache-2.0
/// @file
/// A number, a vector or a spatial vector of each body of an arm, side by side: what is written for
/// one body is computed for all of them at once, one body in a SIMD lane.
///
/// Spatial vectors (Featherstone, Rigid Body Dynamics Algorithms) are in the world's axes and about
/// the origin of the world. A motion (w; v) turns by w, and moves the body's point that is at the
/// origin by v. A force (n; f) has the moment n about the origin.
#pragma once

#include <cstddef>
#include <cstring>
#include <type_traits>

#include "estimators/math/lanes.h"

namespace tauext::detail {

/// A number of each of P bodies.
template <int P, class Scalar>
struct Each {
  Scalar x[P];  ///< by body

  static Each zero() noexcept { return all(Scalar(0)); }  ///< 0 of each
  static Each all(const Scalar& a) noexcept {             ///< the same of each
    Each e;
    for (Scalar& x : e.x) x = a;
    return e;
  }
  template <int N>
  static Each from(const Vec<N, Scalar>& v) noexcept {  ///< with zeros appended
    Each e = zero();
    for (int i = 0; i < N; ++i) e.x[i] = v[i];
    return e;
  }
  Scalar operator[](int i) const noexcept { return x[i]; }  ///< that of body i
  void set(int i, const Scalar& a) noexcept { x[i] = a; }   ///< that of body i
  /// The same, or, if that saves work, 0 of the bodies before `first`.
  Each since([[maybe_unused]] int first) const noexcept { return *this; }
  void store(Scalar* to) const noexcept {  ///< as numbers side by side
    for (const Scalar& a : x) *to++ = a;
  }
  /// Adds `times` a, which is 0 but for the bodies `first` to `last`.
  void add(const Each& a, const Scalar& times, int first, int last) noexcept {
    for (int i = first; i <= last; ++i) x[i] += times * a.x[i];
  }
  friend Each operator+(Each a, const Each& b) noexcept {  ///< one by one, as all operators
    for (int i = 0; i < P; ++i) a.x[i] += b.x[i];
    return a;
  }
  friend Each operator-(Each a, const Each& b) noexcept {
    for (int i = 0; i < P; ++i) a.x[i] -= b.x[i];
    return a;
  }
  friend Each operator*(Each a, const Each& b) noexcept {
    for (int i = 0; i < P; ++i) a.x[i] *= b.x[i];
    return a;
  }
};

/// Registers full of them; of one body, which needs no padding, the first lane of one.
template <int P>
requires(P % 4 == 0 || P == 1) struct Each<P, double> {
  static constexpr int kCount = (P + 3) / 4;
  Lanes x[kCount];  ///< by body, four in each

  Each() noexcept = default;
  // one by one: GCC 12 copies an aggregate by halves of registers, which loads then wait for
  [[gnu::always_inline]] Each(const Each& e) noexcept { *this = e; }
  [[gnu::always_inline]] Each& operator=(const Each& e) noexcept {
#pragma GCC unroll 4
    for (int k = 0; k < kCount; ++k) x[k] = e.x[k];
    return *this;
  }
  [[gnu::always_inline]] static Each zero() noexcept {
    return all(0);
  }
  [[gnu::always_inline]] static Each all(double a) noexcept {
    Each e;
#pragma GCC unroll 4
    for (int k = 0; k < kCount; ++k) e.x[k] = Lanes{a, a, a, a};
    return e;
  }
  template <int N>
  [[gnu::always_inline]] static Each from(const Vec<N>& v) noexcept {
    Each e;
#pragma GCC unroll 4
    for (int k = 0; k < kCount; ++k) {
      gather_zeros<N>(v, 4 * k, e.x[k]);
    }
    return e;
  }
  [[gnu::always_inline]] double operator[](int i) const noexcept {
    if (__builtin_constant_p(i)) return x[i / 4][i % 4];
    double a;  // with another index, GCC 12 takes an element out of a register by a detour
    std::memcpy(&a, reinterpret_cast<const char*>(x) + static_cast<std::size_t>(i) * sizeof a,
                sizeof a);
    return a;
  }
  [[gnu::always_inline]] void set(int i, double a) noexcept {
    x[i / 4][i % 4] = a;
  }
  [[gnu::always_inline]] Each since(int first) const noexcept {
    Each e = zero();
#pragma GCC unroll 4
    for (int k = first / 4; k < kCount; ++k) e.x[k] = x[k];
    return e;
  }
  [[gnu::always_inline]] void store(double* to) const noexcept {
    if constexpr (P == 1) {
      *to = x[0][0];
      return;
    }
#pragma GCC unroll 4
    for (int k = 0; k < P / 4; ++k) detail::store(to + 4 * k, x[k]);
  }
  [[gnu::always_inline]] void add(const Each& a, double times, int first, int last) noexcept {
    const Lanes t{times, times, times, times};
#pragma GCC unroll 4
    for (int k = 0; k < kCount; ++k) {
      if (4 * k <= last && first < 4 * k + 4) x[k] += a.x[k] * t;
    }
  }
  [[gnu::always_inline]] friend Each operator+(const Each& a, const Each& b) noexcept {
    Each e;
#pragma GCC unroll 4
    for (int k = 0; k < kCount; ++k) e.x[k] = a.x[k] + b.x[k];
    return e;
  }
  [[gnu::always_inline]] friend Each operator-(const Each& a, const Each& b) noexcept {
    Each e;
#pragma GCC unroll 4
    for (int k = 0; k < kCount; ++k) e.x[k] = a.x[k] - b.x[k];
    return e;
  }
  [[gnu::always_inline]] friend Each operator*(const Each& a, const Each& b) noexcept {
    Each e;
#pragma GCC unroll 4
    for (int k = 0; k < kCount; ++k) e.x[k] = a.x[k] * b.x[k];
    return e;
  }
};

/// A vector of each.
template <int P, class Scalar>
struct Each3 {
  using One = Each<P, Scalar>;                            ///< a component of each
  One x = One::zero(), y = One::zero(), z = One::zero();  ///< components

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
    if constexpr (P % 4 == 0 && std::is_same_v<Scalar, double>) {
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

  /// What it takes to move so: (tr(Sigma) w - Sigma w + h x v; m v - h x w).
  [[gnu::always_inline]] EachForce<P, Scalar> operator*(
      const EachMotion<P, Scalar>& a) const noexcept {
    const Each<P, Scalar> trace = Sigma.x.x + Sigma.y.y + Sigma.z.z;
    return {trace * a.w - Sigma * a.w + cross(h, a.v), m * a.v - cross(h, a.w)};
  }
};

}  // namespace tauext::detail
