// SPDX-License-Identifier: Apache-2.0
/// @file
/// The numbers of a run among those of several: what an estimator lists in memory(), and what its
/// Parameters hold.
#pragma once

#include <array>
#include <cstddef>
#include <tuple>
#include <utility>

#include "estimators/math/block.h"
#include "estimators/math/pack.h"
#include "estimators/parameters.h"
#include "estimators/sampling.h"

namespace tauext::detail {

// calls f(number, numbers) with all numbers of what a run remembers, and those of the Pack

template <int W, class F>
[[gnu::always_inline]] inline void for_numbers(double& one, Pack<W>& all, const F& f) noexcept {
  f(one, all);
}
// rows beyond those of all repeat the first: see Sampling
template <int Rows, int AllRows, int Columns, int W, class F>
void for_numbers(Eigen::Matrix<double, Rows, Columns>& one,
                 Eigen::Matrix<Pack<W>, AllRows, Columns>& all, const F& f) noexcept {
  for (int j = 0; j < Columns; ++j) {
    for (int i = 0; i < Rows; ++i) f(one(i, j), all(i < AllRows ? i : 0, j));
  }
}
// rows beyond those of all are padding
template <int P, int AllP, int W, class F>
void for_numbers(Each<P, double>& one, Each<AllP, Pack<W>>& all, const F& f) noexcept {
  for (int i = 0; i < AllP; ++i) {
    double x = one[i];
    f(x, all.x[i]);
    one.set(i, x);
  }
}
template <int N, int W, class F>
void for_numbers(Block<N>& one, Block<N, Pack<W>>& all, const F& f) noexcept {
  for (int j = 0; j < N; ++j) for_numbers(one.column[j], all.column[j], f);
}
template <class One, class All, class F>
requires requires(One& one, All& all) {
  one.memory(), all.memory();
}
void for_numbers(One& one, All& all, const F& f) noexcept;
template <class... One, class... All, class F>
void for_numbers(std::tuple<One&...> one, std::tuple<All&...> all, const F& f) noexcept {
  [&]<std::size_t... I>(std::index_sequence<I...>) {
    (for_numbers(std::get<I>(one), std::get<I>(all), f), ...);
  }
  (std::index_sequence_for<One...>());
}

template <class One, class All, class F>
requires requires(One& one, All& all) {
  one.memory(), all.memory();
}
void for_numbers(One& one, All& all, const F& f) noexcept {
  for_numbers(one.memory(), all.memory(), f);
}

// all but the first, and copies of what is referred to
template <class First, class... Rest>
std::tuple<Rest&...> rest(const std::tuple<First&, Rest&...>& t) noexcept {
  return std::apply([](First&, Rest&... r) { return std::tie(r...); }, t);
}
template <class... T>
std::tuple<T...> values(const std::tuple<T&...>& t) noexcept {
  return t;
}

template <int W, class T>
void pack_field(const T& one, int i, T& all) {
  require(i == 0 || one == all,
          "runs at once may differ in numbers: not in a choice, max_gap or Ts");
  all = one;
}
template <int W>
void pack_field(const double& one, int i, Pack<W>& all) {
  all.set(i, one);
}
template <int W, int Rows, int Columns>
void pack_field(const Eigen::Matrix<double, Rows, Columns>& one, int i,
                Eigen::Matrix<Pack<W>, Rows, Columns>& all) {
  for (Eigen::Index k = 0; k < one.size(); ++k) all.data()[k].set(i, one.data()[k]);
}

// the members of all Parameters P: those of fields(), and those that it leaves out
template <class P>
constexpr auto members_of() {
  const auto named = std::apply([](const auto&... f) { return std::tuple(f.at...); }, P::fields());
  if constexpr (requires { P::unnamed(); }) {
    return std::tuple_cat(named, P::unnamed());
  } else {
    return named;
  }
}

template <class All, class P, std::size_t W>
All packed(const std::array<P, W>& p) {
  constexpr auto one = members_of<P>();
  constexpr auto all = members_of<All>();
  All out;
  for (std::size_t i = 0; i < W; ++i) {
    [&]<std::size_t... I>(std::index_sequence<I...>) {
      (pack_field<static_cast<int>(W)>(p[i].*std::get<I>(one), static_cast<int>(i),
                                       out.*std::get<I>(all)),
       ...);
    }
    (std::make_index_sequence<std::tuple_size_v<decltype(one)>>());
  }
  return out;
}

}  // namespace tauext::detail
