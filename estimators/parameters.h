// SPDX-License-Identifier: Apache-2.0
/// @file
/// Parameters of estimators and detectors, each listed once: what may be set by name, its unit, its
/// limits and what it does. A `struct Parameters` lists them in a static function:
///
///     static constexpr auto fields() {
///       return std::tuple(Field{"w", &Parameters::w, "rad/s", 1e-3, 1e5, "larger lets less pass"});
///     }
/// The constructor's check, specifications (`high_pass:w=60`), their help and errors all read this
/// list.
#pragma once

#include <array>
#include <cstdio>
#include <stdexcept>
#include <tuple>
#include <type_traits>

#include "estimators/types.h"

namespace tauext {

/// A number, a vector, a whole number or a choice (an enum) in P. A vector has a value for each
/// joint, unless `effect` says otherwise (covariances of the EKF). Limits include their ends; a
/// choice has none.
template <class P, class T>
struct Field {
  const char* key;     ///< as a specification names it
  T P::*at;            ///< the member
  const char* unit;    ///< "1" for a pure number, "" for a choice
  double least, most;  ///< limits, ends included
  const char* effect;  ///< what larger does, in a line
};
/// So that Field{..} needs no arguments.
template <class P, class T>
Field(const char*, T P::*, const char*, double, double, const char*) -> Field<P, T>;

/// The Parameters of another class inside of P, whose keys are `key.their_key`.
template <class P, class Inner>
struct Nested {
  const char* key;  ///< as a specification names it
  Inner P::*at;     ///< the member
};
/// So that Nested{..} needs no arguments.
template <class P, class Inner>
Nested(const char*, Inner P::*) -> Nested<P, Inner>;

/// One value of an enum by name; an enum that is a parameter has an overload
/// `constexpr auto choices(E) -> std::array<Choice<E>, n>` beside it.
template <class E>
struct Choice {
  const char* name;  ///< as a specification names it
  E value;           ///< the enumerator
};

inline constexpr double kLeastBandwidth = 1e-3;  ///< [rad/s] of a bandwidth or a cut-off
inline constexpr double kMostBandwidth = 1e6;    ///< [rad/s]

/// Where the list of P's fields stands: in P::fields(). A struct that must not include this file
/// has a specialisation instead, beside who sets it by name.
template <class P>
struct FieldsOf {
  /// The list.
  static constexpr auto list() requires requires { P::fields(); }
  { return P::fields(); }
};

/// Parameters that list their fields.
template <class P>
concept ListsFields = requires {
  FieldsOf<P>::list();
};

/// Calls visit(field) for every field of P, nested ones left out.
template <ListsFields P, class Visit>
constexpr void for_each_field(Visit&& visit) {
  std::apply([&](const auto&... field) { (visit(field), ...); }, FieldsOf<P>::list());
}

namespace detail {

[[noreturn]] inline void fail_limit(const char* key, const char* unit, const char* of, double value,
                                    double least, double most) {
  char text[200];
  std::snprintf(text, sizeof text, "%s [%s] of %s is %g: it must be %g to %g", key, unit, of, value,
                least, most);
  throw std::invalid_argument(text);
}

template <class P, class T>
void check_field(const Field<P, T>& f, const P& p, const char* of) {
  [[maybe_unused]] const auto check = [&](double x) {
    if (!(x >= f.least && x <= f.most)) fail_limit(f.key, f.unit, of, x, f.least, f.most);
  };
  if constexpr (std::is_arithmetic_v<T>) {
    check(static_cast<double>(p.*f.at));
  } else if constexpr (requires(T x) {
                         check(x[0]);
                         x.size();
                       }) {  // no choice, and no Pack
    for (Eigen::Index i = 0; i < (p.*f.at).size(); ++i) check((p.*f.at)[i]);
  }
}

template <class P, class Inner>
void check_field(const Nested<P, Inner>&, const P&, const char*) {}  // its own class checks it

[[noreturn]] inline void fail_joints(const char* key, const char* of, Eigen::Index values,
                                     int joints) {
  char text[200];
  std::snprintf(text, sizeof text, "%s of %s has %d values for %d joints: give one, or one each",
                key, of, static_cast<int>(values), joints);
  throw std::invalid_argument(text);
}

}  // namespace detail

/// @param of the name of the estimator or detector, for the error
/// @returns p
/// @throws std::invalid_argument for a value beyond its limits, or NaN: "w [rad/s] of high_pass is
/// 0: .."
template <ListsFields P>
const P& check_parameters(const P& p, const char* of) {
  for_each_field<P>([&](const auto& f) { detail::check_field(f, p, of); });
  return p;
}

/// Parameters of a detector, checked, and with a value for each joint where one stands for all;
/// those of a detector within are left to its own class.
/// @param joints 1 to kMostDof
/// @param of the name of the detector, for the error
/// @throws std::invalid_argument as check_parameters does, and for another number of values
template <ListsFields P>
P for_joints(P p, int joints, const char* of) {
  if (joints < 1 || joints > kMostDof) detail::fail_limit("joints", "1", of, joints, 1, kMostDof);
  check_parameters(p, of);
  for_each_field<P>([&](const auto& f) {
    auto& x = p.*f.at;
    if constexpr (std::is_same_v<decltype(x), JointVec<>&>) {
      if (x.size() == 1) x = JointVec<>::Constant(joints, x[0]);
      if (x.size() != joints) detail::fail_joints(f.key, of, x.size(), joints);
    }
  });
  return p;
}

}  // namespace tauext
