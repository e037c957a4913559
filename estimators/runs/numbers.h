// SPDX-License-Identifier: Apache-2.0
/// @file
/// The numbers of a run among those of several: what an estimator lists in memory(), and what its
/// Parameters hold.
#pragma once

#include <array>
#include <concepts>
#include <cstddef>
#include <stdexcept>
#include <string>
#include <tuple>
#include <type_traits>
#include <utility>

#include "estimators/math/block.h"
#include "estimators/math/pack.h"
#include "estimators/parameters.h"
#include "estimators/sampling.h"

namespace tauext::detail {

// calls f(number, numbers) with all numbers of what a run remembers, and those of the Pack

template <class One, class All, class F>
void for_numbers(One&, All&, const F&) noexcept {
  static_assert(sizeof(One) == 0,
                "memory() lists numbers of the model (Scalar), vectors and matrices of these, and "
                "what has a memory() of its own; a whole number or a bool counts in a Scalar");
}
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

// false if it must be that of the first run, and is not
template <int W, class T>
bool pack_field(const T& one, int i, T& all) {
  if (i > 0) return one == all;
  all = one;
  return true;
}
template <int W>
bool pack_field(const double& one, int i, Pack<W>& all) {
  all.set(i, one);
  return true;
}
template <int W, int Rows, int Columns>
bool pack_field(const Eigen::Matrix<double, Rows, Columns>& one, int i,
                Eigen::Matrix<Pack<W>, Rows, Columns>& all) {
  for (Eigen::Index k = 0; k < one.size(); ++k) all.data()[k].set(i, one.data()[k]);
  return true;
}

// the members of all Parameters P: those of fields(), and those that it leaves out
template <class P>
constexpr auto listed_members() {
  const auto named = std::apply([](const auto&... f) { return std::tuple(f.at...); }, P::fields());
  if constexpr (requires { P::unnamed(); }) {
    return std::tuple_cat(named, P::unnamed());
  } else {
    return named;
  }
}

// what a member of any type may be made of
struct Anything {
  template <class T>
  operator T() const;  // NOLINT(google-explicit-constructor): it stands for one
};
// how many members the aggregate P has
template <class P, class... Members>
constexpr std::size_t count_members() {
  if constexpr (requires { P{Members()..., Anything()}; }) {
    return count_members<P, Members..., Anything>();
  } else {
    return sizeof...(Members);
  }
}

// true if each of the pointers to members is another one
template <class... At>
constexpr bool all_differ(const std::tuple<At...>& list) {
  const auto same = []<class A, class B>(A a, B b) {
    if constexpr (std::same_as<A, B>) return a == b;
    return false;
  };
  const auto times = [&](auto a) {
    return std::apply([&](auto... b) { return (0 + ... + same(a, b)); }, list);
  };
  return std::apply([&](auto... a) { return ((times(a) == 1) && ...); }, list);
}

template <class P>
constexpr auto members_of() {
  constexpr auto all = listed_members<P>();
  static_assert(std::is_aggregate_v<P> && all_differ(all) &&
                    count_members<P>() == std::tuple_size_v<decltype(all)>,
                "Parameters is an aggregate that lists each of its members once, in fields(), or, "
                "if a specification does not name it, as a pointer to member in unnamed()");
  return all;
}

// what a specification calls the member of that number
template <class P>
std::string key_of_member(std::size_t number) {
  const auto keys = std::apply([](const auto&... f) { return std::array{f.key...}; }, P::fields());
  return number < keys.size() ? keys[number] : "a parameter without a key";
}

// @throws std::invalid_argument where runs differ in what must be the same
template <class All, class P, std::size_t W>
All packed(const std::array<P, W>& p) {
  constexpr auto one = members_of<P>();
  constexpr auto all = members_of<All>();
  All out;
  for (std::size_t i = 0; i < W; ++i) {
    [&]<std::size_t... I>(std::index_sequence<I...>) {
      const auto pack = [&](auto number, const auto& mine, auto& of_all) {
        if (pack_field<static_cast<int>(W)>(mine, static_cast<int>(i), of_all)) return;
        throw std::invalid_argument("run " + std::to_string(i) + " has another " +
                                    key_of_member<P>(number) +
                                    " than run 0; runs at once may differ in a Scalar of their "
                                    "Parameters, but not in a double, as max_gap and Ts are, nor "
                                    "in a choice");
      };
      (pack(std::integral_constant<std::size_t, I>(), p[i].*std::get<I>(one),
            out.*std::get<I>(all)),
       ...);
    }
    (std::make_index_sequence<std::tuple_size_v<decltype(one)>>());
  }
  return out;
}

}  // namespace tauext::detail
