// SPDX-License-Identifier: Apache-2.0
/// @file
/// Runs for studies in which an arm meets regions of a person's body.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "mjcf/plant/model.h"
#include "mjcf/scenarios/regions.h"

namespace tauext {

/// A kind of meeting that is counted by itself.
struct RegionClass {
  std::string name;                    ///< like hand_0.25, chest_50%, abdomen_clamped
  std::string kind;                    ///< the same without the region, like 0.25
  Meeting meeting = Meeting::kFree;    ///< how
  const BodyRegion* region = nullptr;  ///< what
  double speed = 0;                    ///< [m/s] of a free one; 0: share_of_limit
  double share_of_limit = 0;           ///< [1] RegionTouch's, of a free one

  /// [N] that must not be exceeded: of a quasi-static contact for a clamped one, else of a
  /// transient one.
  double limit() const {
    return meeting == Meeting::kClamped ? region->clamp_limit : region->impact_limit;
  }
};

/// Hand, lower and upper arm, chest and abdomen, free at 0.10 and 0.25 m/s and at the speeds of 25,
/// 50 and 100 % of the limit, and grazing; hand, lower arm and abdomen clamped.
const std::vector<RegionClass>& region_classes();

/// Where an arm can be touched: on its last links.
class TouchPoints {
 public:
  /// @param home [rad] a pose about which it moves
  /// @throws std::invalid_argument if nothing there moves, or has a name
  TouchPoints(const Model& model, const Eigen::VectorXd& home);

  /// Meetings of region_classes()[of], one after the other, 1 to 2 s apart, between `from` and
  /// `until` [s]: at random points of the last three links that move, in random directions in
  /// which the point moves, with half, once or twice the region's stiffness. A clamping rises to
  /// its limit in 0.1 to 0.3 s and holds for 1 s; a grazing would press with a quarter of its
  /// limit, for 20 to 60 ms.
  std::vector<RegionTouch> draw(std::size_t of, std::uint64_t seed, double from,
                                double until) const;

 private:
  struct Link {
    std::string from, to;
    Eigen::MatrixXd J_from, J_to;  // [m/rad] at home, world frame
  };
  std::vector<Link> links_;
};

}  // namespace tauext
