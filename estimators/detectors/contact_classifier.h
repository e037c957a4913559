// SPDX-License-Identifier: Apache-2.0
/// @file
/// What kind of contact it is. pan_tompkins.h sees a blow and no slow clamping, clamping.h sees a
/// slow clamping and no blow, and neither knows a hand from nothing; together they do. At every
/// sample, the first line that holds:
///     within `hold` of a mark of pan_tompkins                          collision
///     clamping's score is at least 1                                   clamping
///     max_i(|z_i| / intentional_i) >= 1, z as in clamping.h            intentional
///     else                                                             none
/// A collision is marked where pan_tompkins marks, a clamping where its score rises through 1 (or
/// is above it when a collision's `hold` ends: then the arm hit something and is caught there).
/// Known limit: a payload that the model lacks changes tau_ext as the arm moves, and that reads as
/// intentional, too.
#pragma once

#include <algorithm>
#include <tuple>

#include "estimators/detectors/clamping.h"
#include "estimators/detectors/pan_tompkins.h"

namespace tauext {

/// Classifier over N joints.
template <int N>
class ContactClassifier {
 public:
  static constexpr const char* kName = "contact_classifier";
  static constexpr int kDof = N;

  struct Parameters {
    typename PanTompkins<N>::Parameters collision{};  ///< of what finds a blow
    typename Clamping<N>::Parameters clamping{};      ///< of what finds a clamping
    /// [N m] per joint from where on a change counts as a touch: larger overlooks light hands; by
    /// default 15 N at 1 m
    Vec<N> intentional = Vec<N>::Constant(15);
    double hold = 0.3;  ///< [s] for which a collision is one: larger delays what comes after it

    static constexpr auto fields() {
      using P = Parameters;
      return std::tuple(
          Nested{"collision", &P::collision}, Nested{"clamping", &P::clamping},
          Field{"intentional", &P::intentional, "N m", 1e-12, 1e15, "larger overlooks light hands"},
          Field{"hold", &P::hold, "s", 0, 1e3, "how long a collision is one"});
    }
  };

  /// @throws std::invalid_argument for parameters out of range
  explicit ContactClassifier(const Parameters& p = {})
      : p_(check_parameters(p, kName)), collision_(p.collision), clamping_(p.clamping) {}

  void reset() noexcept {
    clock_.reset();
    collision_.reset();
    clamping_.reset();
    forget();
  }

  Detection update(double t, const Vec<N>& tau_ext) noexcept {
    const Status status = clock_.accept(t);
    if (!used(status)) return {false, last_.score, last_.contact};
    if (status == Status::kStarted) forget();
    last_ = classified(t, tau_ext);
    return last_;
  }

 private:
  void forget() noexcept {
    hit_ = clamped_ = clamp_marked_ = false;
    last_ = {};
  }

  Detection classified(double t, const Vec<N>& tau_ext) noexcept {
    const Detection hit = collision_.update(t, tau_ext);
    const Detection clamp = clamping_.update(t, tau_ext);
    const double score = std::max(hit.score, clamp.score);
    if (hit.mark) {
      hit_ = true;
      hit_at_ = t;
    }
    if (hit_ && t - hit_at_ < p_.hold) {
      clamped_ = false;
      return {hit.mark, score, Contact::kCollision};
    }
    const bool clamped = clamp.score >= 1;
    const bool rested = !clamp_marked_ || t - clamp_marked_at_ >= p_.clamping.refractory;
    const bool mark = clamped && !clamped_ && rested;
    clamped_ = clamped;
    if (mark) {
      clamp_marked_ = true;
      clamp_marked_at_ = t;
    }
    if (clamped) return {mark, score, Contact::kClamping};
    const bool touched =
        clamping_.change().cwiseAbs().cwiseQuotient(p_.intentional).maxCoeff() >= 1;
    return {false, score, touched ? Contact::kIntentional : Contact::kNone};
  }

  Parameters p_;
  PanTompkins<N> collision_;
  Clamping<N> clamping_;
  Clock clock_{Marking::kMaxGap};  // says what those of both stages say
  bool hit_ = false, clamped_ = false, clamp_marked_ = false;
  double hit_at_ = 0, clamp_marked_at_ = 0;  // [s]
  Detection last_;
};

static_assert(CollisionDetector<ContactClassifier<3>>);

}  // namespace tauext
