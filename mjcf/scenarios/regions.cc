// SPDX-License-Identifier: Apache-2.0
#include "mjcf/scenarios/regions.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

#include "mjcf/trace/known.h"

namespace tauext {
namespace {

void require(double value, const char* what, double least, double most) {
  if (value >= least && value <= most) return;
  throw std::invalid_argument(
      fmt::format("{} is {}, and must be {:g} to {:g}", what, value, least, most));
}

}  // namespace

const BodyRegion& body_region(std::string_view name) {
  return find_known(kBodyRegions, "body region", name,
                    [](const BodyRegion& r) { return std::string(r.name); });
}

double RegionTouch::end() const {
  switch (meeting) {
    case Meeting::kClamped:
      return begin + rise + hold + fall;
    case Meeting::kGrazing:
      return begin + 2 * rise;
    case Meeting::kFree:
      break;
  }
  // half an oscillation against a wall is the longest; the arm may follow
  return begin + 3 * std::numbers::pi * std::sqrt(region->mass / stiffness());
}

double RegionTouch::overlap(double t) const {
  const double way = (t - begin) / rise - 1;  // -1 to 1
  return std::max(0., depth * (1 - way * way));
}

double RegionTouch::ramp(double t) const {
  const double since = t - begin;
  if (since < 0 || t >= end()) return 0;
  return force * (since < rise ? since / rise : since < rise + hold ? 1 : (end() - t) / fall);
}

double reduced_mass(const BodyRegion& region, double arm) {
  return 1 / (1 / region.mass + 1 / arm);
}

void check(const std::vector<RegionTouch>& touches) {
  double last = -std::numeric_limits<double>::infinity();
  for (const RegionTouch& t : touches) {
    require(t.begin, "the begin [s] of a touch", std::max(last, 0.), 1e6);
    require(t.stiffness_factor, "stiffness_factor", 0.1, 10);
    require(t.at.share, "the share of a point between two others", 0, 1);
    require(t.direction.norm(), "the length of a direction", 1 - 1e-9, 1 + 1e-9);
    if (t.meeting == Meeting::kFree && t.share_of_limit == 0)
      require(t.speed, "speed [m/s]", 1e-3, 5);
    if (t.meeting == Meeting::kFree && t.share_of_limit != 0) {
      require(t.share_of_limit, "share_of_limit", 1e-3, 10);
      if (t.region->impact_limit == 0)
        throw std::invalid_argument(
            fmt::format("share_of_limit: the {} has no impact limit, as it must not be touched; "
                        "give a speed",
                        t.region->name));
    }
    if (t.meeting == Meeting::kGrazing) require(t.depth, "depth [m]", 1e-6, 0.1);
    if (t.meeting != Meeting::kFree) require(t.rise, "rise [s]", 1e-3, 100);
    if (t.meeting == Meeting::kClamped) {
      require(t.force, "force [N]", 1e-3, 1e4);
      require(t.hold, "hold [s]", 0, 1000);
      require(t.fall, "fall [s]", 1e-3, 100);
    }
    last = t.end();
  }
}

}  // namespace tauext
