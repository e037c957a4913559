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
#include <cmath>
#include <tuple>

#include "estimators/detectors/clamping.h"
#include "estimators/detectors/pan_tompkins.h"

namespace tauext {

/// What can be chosen of a ContactClassifier.
struct ContactClassifierParameters {
  PanTompkinsParameters collision{};  ///< of what finds a blow
  ClampingParameters clamping{};      ///< of what finds a clamping
  /// [N m] per joint from where on a change counts as a touch: larger overlooks light hands; by
  /// default 15 N at 1 m
  JointVec<> intentional = JointVec<>::Constant(1, 15);
  double hold = 0.3;  ///< [s] for which a collision is one: larger delays what comes after it

  static constexpr auto fields() {
    using P = ContactClassifierParameters;
    return std::tuple(
        Nested{"collision", &P::collision}, Nested{"clamping", &P::clamping},
        Field{"intentional", &P::intentional, "N m", 1e-12, 1e15, "larger overlooks light hands"},
        Field{"hold", &P::hold, "s", 0, 1e3, "how long a collision is one"});
  }
};

/// The classifier; with a Pack for Scalar, of several runs.
template <class Scalar = double>
class BasicContactClassifier {
 public:
  static constexpr const char* kName = "contact_classifier";
  using Parameters = ContactClassifierParameters;  ///< what can be set
  template <class Other>
  using For = BasicContactClassifier<Other>;  ///< the same, computed with another number

  /// @throws std::invalid_argument as for_joints() (estimators/parameters.h)
  explicit BasicContactClassifier(int joints, const Parameters& p = {})
      : p_(for_joints(p, joints, kName)),
        collision_(joints, p.collision),
        clamping_(joints, p.clamping) {}

  const Parameters& parameters() const noexcept { return p_; }  ///< as constructed

  void reset() noexcept {
    clock_.reset();
    collision_.reset();
    clamping_.reset();
    forget();
  }

  DetectionOf<Scalar> update(double t, const JointVecView<Scalar>& tau_ext) noexcept {
    const bool fits = tau_ext.size() == clamping_.change().size();
    const Status status = fits ? clock_.accept(t) : Status::kBadMeasurement;
    if (!used(status)) return {no<Scalar>(), last_.score, last_.contact};
    if (status == Status::kStarted) forget();
    last_ = classified(t, tau_ext);
    return last_;
  }

 private:
  void forget() noexcept {
    hit_at_ = clamp_marked_at_ = kNever;
    clamped_ = no<Scalar>();
    last_ = {no<Scalar>(), 0, contact_as<Scalar>(Contact::kNone)};
  }

  DetectionOf<Scalar> classified(double t, const JointVecView<Scalar>& tau_ext) noexcept {
    using std::max;
    const DetectionOf<Scalar> hit = collision_.update(t, tau_ext);
    const DetectionOf<Scalar> clamp = clamping_.update(t, tau_ext);
    hit_at_ = select(hit.mark, Scalar(t), hit_at_);
    const MaskOf<Scalar> collides = t - hit_at_ < p_.hold;
    const MaskOf<Scalar> clamped = (clamp.score >= 1) & !collides;
    const MaskOf<Scalar> rested = t - clamp_marked_at_ >= p_.clamping.refractory;
    const MaskOf<Scalar> clamp_mark = clamped & !clamped_ & rested;
    clamped_ = clamped;
    clamp_marked_at_ = select(clamp_mark, Scalar(t), clamp_marked_at_);
    using std::abs;
    Scalar most = 0;
    for (int i = 0; i < tau_ext.size(); ++i)
      most = max(most, abs(clamping_.change()[i]) / Scalar(p_.intentional[i]));
    const MaskOf<Scalar> touched = most >= 1;
    const MaskOf<Scalar> mark = (hit.mark & collides) | clamp_mark;
    const auto as = [](Contact c) { return contact_as<Scalar>(c); };
    return {mark, max(hit.score, clamp.score),
            select(collides, as(Contact::kCollision),
                   select(clamped, as(Contact::kClamping),
                          select(touched, as(Contact::kIntentional), as(Contact::kNone))))};
  }

  Parameters p_;
  BasicPanTompkins<Scalar> collision_;
  BasicClamping<Scalar> clamping_;
  Clock clock_{Marking::kMaxGap};                      // says what those of both stages say
  Scalar hit_at_ = kNever, clamp_marked_at_ = kNever;  // [s]
  MaskOf<Scalar> clamped_ = no<Scalar>();
  DetectionOf<Scalar> last_ = {no<Scalar>(), 0, contact_as<Scalar>(Contact::kNone)};
};

/// Of one run.
using ContactClassifier = BasicContactClassifier<>;
static_assert(CollisionDetector<ContactClassifier>);

}  // namespace tauext
