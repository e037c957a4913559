// SPDX-License-Identifier: Apache-2.0
/// @file
/// Regions of a body that a simulated arm meets, one after the other.
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "mjcf/plant/plant.h"
#include "mjcf/scenarios/regions.h"

namespace tauext::detail {

// of a Plant or a TreePlant
template <class P>
class RegionContact {
  using Vector = typename P::Vector;
  using Place = typename P::Place;

 public:
  // @throws std::invalid_argument as check(touches) does, and for an unknown point
  RegionContact(const std::vector<RegionTouch>& touches, const P& plant) : touches_(touches) {
    check(touches);
    for (const RegionTouch& t : touches) {
      from_.push_back(plant.place(t.at.from));
      to_.push_back(plant.place(t.at.to));
    }
  }

  // whether one begins or is over at t
  void look(const P& plant, double t) {
    if (now_ != nullptr && is_over(plant, t)) now_ = nullptr, ++next_;
    if (now_ != nullptr || next_ == touches_.size()) return;
    if (t < touches_[next_].begin - 1e-9) return;
    now_ = &touches_[next_];
    pressed_ = false;
    const Point arm = point(plant);
    x_ = along(arm.position);
    v_ = along(arm.velocity);
    if (now_->meeting == Meeting::kFree) v_ += approach(plant);
  }

  // whether its force changes within a sample, by what the arm does
  bool is_coupled() const { return now_ != nullptr && now_->meeting != Meeting::kClamped; }

  // [N] at t
  double force(const P& plant, double t) const {
    if (now_ == nullptr) return 0;
    if (now_->meeting == Meeting::kClamped) return now_->ramp(t);
    return spring(t, x_ - along(point(plant).position));
  }
  // -J^T f [N m] of f [N]
  Vector tau_ext_of(const P& plant, double f) const {
    const double share = now_->at.share;
    return (1 - share) * plant.tau_ext_of(f * now_->direction, from_[next_]) +
           share * plant.tau_ext_of(f * now_->direction, to_[next_]);
  }

  // Parts of h [s] that arm and region take together: of 0.1 ms, in which a hand's oscillation
  // turns by 0.05 rad.
  static int parts(double h) { return std::max(1, static_cast<int>(std::lround(h / 1e-4))); }

  // [N] to be held from t on for h [s], a part: what it is in its middle, of second order, as
  // leapfrog
  double push(const P& plant, double t, double h) {
    const Point arm = point(plant);
    const double ahead = x_ - along(arm.position) + h / 2 * (v_ - along(arm.velocity));
    f_ = spring(t + h / 2, ahead);
    pressed_ = pressed_ || f_ > 0;
    return f_;
  }
  // h [s] on
  void move(double h) {
    const double a = -f_ / now_->region->mass;
    x_ += h * (v_ + h / 2 * a);
    v_ += h * a;
  }

 private:
  double along(const Eigen::Vector3d& v) const { return now_->direction.dot(v); }
  Point point(const P& plant) const {
    const Point a = plant.point(from_[next_]), b = plant.point(to_[next_]);
    const double share = now_->at.share;
    return {a.position + share * (b.position - a.position),
            a.velocity + share * (b.velocity - a.velocity)};
  }
  double spring(double t, double overlap) const {
    if (now_->meeting == Meeting::kGrazing) overlap += now_->overlap(t);
    return now_->stiffness() * std::max(0., overlap);
  }
  // [m/s]
  double approach(const P& plant) const {
    if (now_->share_of_limit == 0) return now_->speed;
    const Vector w = tau_ext_of(plant, 1);
    const double mu = reduced_mass(*now_->region, 1 / w.dot(plant.inertia().llt().solve(w)));
    return now_->share_of_limit * now_->region->impact_limit / std::sqrt(mu * now_->stiffness());
  }
  bool is_over(const P& plant, double t) const {
    if (t >= now_->end()) return true;
    return now_->meeting == Meeting::kFree && pressed_ && force(plant, t) == 0;
  }

  const std::vector<RegionTouch>& touches_;
  std::vector<Place> from_, to_;
  std::size_t next_ = 0;
  const RegionTouch* now_ = nullptr;
  double x_ = 0, v_ = 0;  // [m], [m/s] of the region's surface along the direction
  double f_ = 0;          // [N] of the present part
  bool pressed_ = false;
};

}  // namespace tauext::detail
