// SPDX-License-Identifier: Apache-2.0
/// @file
/// Which body of a tree is carried by which, and sums and poses along it.
#pragma once

#include <type_traits>

#include "estimators/tree/spatial.h"

namespace tauext::detail {

/// The order of N bodies, each carried by an earlier one or by the base.
template <int N, class Scalar>
class TreeSums {
 public:
  static constexpr int P = kPadded<N, Scalar>;  ///< lanes
  /// Whether bodies stand in the lanes of a register, where masks take sums; else one by one.
  static constexpr bool kInLanes = std::is_same_v<Scalar, double>;
  using One = Each<P, Scalar>;     ///< a number of each
  using Three = Each3<P, Scalar>;  ///< vectors
  using Motion = EachMotion<P, Scalar>;
  using Force = EachForce<P, Scalar>;

  TreeSums() {
    for (int i = 0; i < N; ++i) behind_[i] = strictly_behind_[i] = ahead_[i] = One::zero();
  }

  /// Adds body i, the next one. `parent` is the body that carries it; -1: the base.
  void add(int i, int parent) {
    parent_[i] = parent;
    for (int k = i; k >= 0; k = parent_[k]) {
      behind_[k].set(i, Scalar(1));
      strictly_behind_[k].set(i, Scalar(k == i ? 0 : 1));
      ahead_[i].set(k, Scalar(1));
    }
  }

  int parent(int i) const noexcept { return parent_[i]; }         ///< what carries i; -1: the base
  const One& behind(int i) const noexcept { return behind_[i]; }  ///< 1 in i's subtree, else 0
  const One& strictly_behind(int i) const noexcept { return strictly_behind_[i]; }  ///< 0 for i
  const One& ahead(int i) const noexcept { return ahead_[i]; }  ///< 1 if it carries i, or is i

  /// For each body the sum over all that carry it, and itself.
  [[gnu::always_inline]] One from_base(const One& x) const noexcept {
    if constexpr (!kInLanes) {
      One sum = x;
      for (int i = 0; i < N; ++i) {
        if (parent_[i] >= 0) sum.x[i] += sum.x[parent_[i]];
      }
      return sum;
    } else {
      One sum = One::zero();
#pragma GCC unroll 8
      for (int i = 0; i < N; ++i) sum.add(behind_[i], x[i], i, P - 1);
      return sum;
    }
  }
  [[gnu::always_inline]] Motion from_base(const Motion& m) const noexcept {
    return {{from_base(m.w.x), from_base(m.w.y), from_base(m.w.z)},
            {from_base(m.v.x), from_base(m.v.y), from_base(m.v.z)}};
  }

  /// For each body the sum over its subtree: all that it carries, and itself.
  [[gnu::always_inline]] One subtree(const One& x) const noexcept {
    if constexpr (!kInLanes) {
      One sum = x;
      for (int i = N - 1; i > 0; --i) {
        if (parent_[i] >= 0) sum.x[parent_[i]] += sum.x[i];
      }
      return sum;
    } else {
      One sum = One::zero();
#pragma GCC unroll 8
      for (int i = 0; i < N; ++i) sum.add(ahead_[i], x[i], 0, i);
      return sum;
    }
  }
  [[gnu::always_inline]] Three subtree(const Three& v) const noexcept {
    return {subtree(v.x), subtree(v.y), subtree(v.z)};
  }
  [[gnu::always_inline]] Force subtree(const Force& f) const noexcept {
    return {subtree(f.n), subtree(f.f)};
  }

  /// Takes R and p, axes and origins, from the frame of each body's parent to that of the base.
  [[gnu::always_inline]] void place(Each33<P, Scalar>& R, Three& p) const noexcept {
    if constexpr (kInLanes) {
      place_in_lanes(R, p);
    } else {
      place_one_by_one(R, p);
    }
  }

 private:
  [[gnu::always_inline]] void place_in_lanes(Each33<P, Scalar>& R, Three& p) const noexcept {
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
    R.x.set_all(x + 1), R.y.set_all(y + 1), R.z.set_all(z + 1), p.set_all(at + 1);
  }

  [[gnu::always_inline]] void place_one_by_one(Each33<P, Scalar>& R, Three& p) const noexcept {
    for (int i = 0; i < N; ++i) {
      if (parent_[i] < 0) continue;
      const auto of_parent = R.piece(parent_[i]);
      R.x.put(i, of_parent * R.x.piece(i));
      R.y.put(i, of_parent * R.y.piece(i));
      R.z.put(i, of_parent * R.z.piece(i));
      p.put(i, p.piece(parent_[i]) + of_parent * p.piece(i));
    }
  }

  int parent_[N];
  One behind_[N], strictly_behind_[N], ahead_[N];
};

}  // namespace tauext::detail
