// SPDX-License-Identifier: Apache-2.0
/// @file
/// Regions of a person's body, and how an arm meets them.
#pragma once

#include <Eigen/Core>
#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "mjcf/plant/plant.h"

namespace tauext {

/// A region of the body as a collision finds it: a mass behind a spring, and the forces that it
/// may be pressed with.
///
/// Limits after ISO/TS 15066:2016, table A.2, masses and stiffnesses after its table A.3, both as
/// others quote them: the standard itself was not read. Its transient limit is twice the clamping
/// one; 0 where no contact is permitted. The BG/BGIA recommendations of 2011 (as quoted by Buxbaum
/// and Sen, Pflegeroboter, 2018, table 1.4) allow less. Both are disputed: Behrens et al. 2022
/// (Front. Robot. AI 8:667818) find most limits unverified.
struct BodyRegion {
  std::string_view name;  ///< a word
  double mass;            ///< [kg] of what moves with it
  double stiffness;       ///< [N/m]
  double clamp_limit;     ///< [N] of a quasi-static contact
  double impact_limit;    ///< [N] of a transient one, 0.5 s at most; 0: must not be touched
  double bg_clamp;        ///< [N] of BG/BGIA 2011
  double bg_impact;       ///< [N] likewise
};

/// All of them.
inline constexpr std::array<BodyRegion, 12> kBodyRegions = {{
    {"hand", 0.6, 75e3, 140, 280, 135, 180},
    {"lower_arm", 2, 40e3, 160, 320, 160, 220},
    {"upper_arm", 3, 30e3, 150, 300, 150, 190},
    {"neck", 1.2, 50e3, 150, 300, 145, 190},
    {"chest", 40, 25e3, 140, 280, 140, 210},
    {"abdomen", 40, 10e3, 110, 220, 110, 160},
    {"pelvis", 40, 25e3, 180, 360, 180, 250},
    {"back", 40, 35e3, 210, 420, 210, 250},
    {"thigh", 75, 50e3, 220, 440, 220, 250},
    {"lower_leg", 75, 60e3, 130, 260, 140, 170},
    {"skull", 4.4, 150e3, 130, 0, 130, 175},
    {"face", 4.4, 75e3, 65, 0, 65, 90},
}};

/// @throws std::invalid_argument for an unknown name, listing the known ones
const BodyRegion& body_region(std::string_view name);

/// A point of a link, on the line between two others: sites, origins of bodies, or kEndEffector.
/// Both must move with one link; the origin of the next link's body does.
struct LinkPoint {
  std::string from = kEndEffector, to = kEndEffector;  ///< names of the others
  double share = 0;                                    ///< [1] of the way, from 0 to 1

  bool operator==(const LinkPoint&) const = default;
};

/// How a region is met.
enum class Meeting {
  kFree,     ///< it comes to the arm, and is pushed away
  kGrazing,  ///< it passes along the arm, and is pressed aside
  kClamped,  ///< it cannot get away: a quasi-static force
};

/// One meeting of a region and an arm. Without friction: the force is along `direction`.
struct RegionTouch {
  Meeting meeting = Meeting::kFree;             ///< how
  const BodyRegion* region = &kBodyRegions[0];  ///< what
  double stiffness_factor = 1;  ///< [1] on the region's, which differs between people
  LinkPoint at;                 ///< where
  double begin = 0;             ///< [s]
  Eigen::Vector3d direction = Eigen::Vector3d::UnitX();  ///< [1] world: of the force on the arm

  // kFree
  double speed = 0.25;  ///< [m/s] at which they approach each other
  /// [1] if above 0, in place of `speed`: that at which the peak force would be this share of the
  /// region's impact_limit.
  double share_of_limit = 0;

  double depth = 0;  ///< [m] kGrazing: of the overlap at its deepest
  double force = 0;  ///< [N] kClamped: of the ramp
  double rise = 0;   ///< [s] kClamped, of the ramp; kGrazing, to the deepest overlap and from there
  double hold = 0;   ///< [s] kClamped
  double fall = 0;   ///< [s] kClamped

  double stiffness() const { return stiffness_factor * region->stiffness; }  ///< [N/m]
  /// [s] when it is over at the latest. A free one is over when the region has been pushed away.
  double end() const;
  /// [m] kGrazing: how far the region would overlap the arm at t [s] if nothing moved
  double overlap(double t) const;
  /// [N] kClamped: at t [s]
  double ramp(double t) const;
};

/// The mass [kg] of the two bodies against each other: 1/mu = 1/region + 1/arm.
/// @param arm [kg] its effective mass at the point along direction n, 1 / (n^T J B^-1 J^T n)
double reduced_mass(const BodyRegion& region, double arm);

/// @throws std::invalid_argument for a value out of range, naming it, and for touches that are not
/// one after the other
void check(const std::vector<RegionTouch>& touches);

}  // namespace tauext
