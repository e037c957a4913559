// SPDX-License-Identifier: Apache-2.0
/// @file
/// What of MJCF the dynamics of an arm needs, as far as MuJoCo 2.2.2 knows it; and what of URDF.
#pragma once

#include <algorithm>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace tauext::detail {

/// Whether a word stands in a list of words that are apart by blanks, one before and behind each.
inline bool has_word(std::string_view list, std::string_view word) {
  return list.find(' ' + std::string(word) + ' ') != list.npos;
}

/// How many letters must be put in, taken out or exchanged to make one word of the other.
inline std::size_t edits(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);  // from the beginning of a to each beginning of b
  for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = std::exchange(row[0], i);
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t other = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({other, row[j] + 1, row[j - 1] + 1});
    }
  }
  return row.back();
}

/// What to do about a word that is in no list: take it out, but for what may be a typing error of
/// one in the list (as in has_word).
inline std::string remedy_for(std::string_view word, std::string_view list) {
  for (std::size_t at = 0, end; (end = list.find(' ', at)) != list.npos; at = end + 1) {
    const std::string_view known = list.substr(at, end - at);
    if (known.size() > 2 && edits(word, known) <= 2)
      return "did you mean '" + std::string(known) + "'? If not, take it out";
  }
  return "take it out";
}

/// An element that is kept, with the attributes that are; those of other elements go with them.
struct Kept {
  std::string_view element;
  std::string_view attributes;  ///< apart by blanks, one before and behind each
};

/// The same within <default>, within bodies and beside them. <tendon> and <equality> have theirs in
/// <default>.
inline constexpr Kept kKept[] = {
    {"compiler",
     " boundmass boundinertia settotalmass balanceinertia coordinate angle eulerseq "
     "inertiafromgeom inertiagrouprange autolimits assetdir meshdir fitaabb "
     "exactmeshinertia "},
    {"option",
     " timestep impratio gravity wind density viscosity solver iterations tolerance "
     "noslip_iterations "},
    {"default", " class "},
    {"worldbody", " "},
    {"body", " name childclass pos quat axisangle xyaxes zaxis euler "},
    {"inertial", " pos quat axisangle xyaxes zaxis euler mass diaginertia fullinertia "},
    {"joint",
     " name class type pos axis springdamper limited range margin ref springref stiffness damping "
     "frictionloss armature solreflimit solimplimit solreffriction solimpfriction "},
    {"freejoint", " name "},
    {"geom",
     " name class type contype conaffinity condim size fromto friction mass density solmix solref "
     "solimp margin gap pos quat axisangle xyaxes zaxis euler mesh fitscale shellinertia "},
    {"site", " name class type size fromto pos quat axisangle xyaxes zaxis euler "},
    {"asset", " "},
    {"mesh", " name class file vertex normal face refpos refquat scale smoothnormal "},
    {"tendon",
     " limited range margin springlength stiffness damping frictionloss solreflimit solimplimit "
     "solreffriction solimpfriction "},
    {"fixed",
     " name class limited range margin springlength stiffness damping frictionloss solreflimit "
     "solimplimit solreffriction solimpfriction "},
    {"equality", " active solref solimp "},
    {"connect", " name class active body1 body2 anchor solref solimp "},
    {"weld", " name class active body1 body2 relpose anchor torquescale solref solimp "},
    {"contact", " "},
    {"exclude", " name body1 body2 "},
    {"custom", " "},
    {"numeric", " name size data "},
};

/// The elements of a list, as has_word takes them.
template <std::size_t n>
std::string elements_of(const Kept (&list)[n]) {
  std::string all = " ";
  for (const Kept& k : list) all += std::string(k.element) + ' ';
  return all;
}

/// Of <equality><joint>, which is another element than a body's.
inline constexpr std::string_view kJointEquality =
    " name class active joint1 joint2 polycoef solref solimp ";
/// Of <equality><tendon>.
inline constexpr std::string_view kTendonEquality =
    " name class active tendon1 tendon2 polycoef solref solimp ";
/// Of <fixed><joint>.
inline constexpr std::string_view kFixedJoint = " joint coef ";

/// Attributes of kept elements, by name, that show things, are about contacts or actuators, or have
/// no part in the dynamics that we take: left out. Any other one is an error.
inline constexpr Kept kLeftOut[] = {
    {"compiler",
     " texturedir discardvisual usethread fusestatic alignfree saveinertial convexhull "
     "convexmesh "},
    {"option",
     " integrator cone jacobian tolerance apirate magnetic o_margin o_solref o_solimp o_friction "
     "noslip_tolerance mpr_iterations mpr_tolerance ccd_iterations ccd_tolerance ls_iterations "
     "ls_tolerance "
     "sdf_iterations sdf_initpoints actuatorgroupdisable sleep_tolerance collision "},
    {"body", " gravcomp user mocap sleep "},
    {"joint", " group user actuatorfrcrange actuatorfrclimited actuatorgravcomp "},
    {"freejoint", " group align "},
    {"geom", " group priority material rgba user hfield fluidshape fluidcoef surfacevel adhesion "},
    {"site", " group material rgba user "},
    {"mesh",
     " maxhullvert inertia content_type builtin params material user texcoord "
     "octree_maxdepth "},
    {"fixed", " group user width rgba actuatorfrcrange actuatorfrclimited "},
    {"tendon", " group user width rgba material actuatorfrcrange actuatorfrclimited "},
};

/// Elements that show things, are about contacts, actuators or sensors, or have no part in the
/// dynamics that we take: left out with all that is in them. Any other one is an error.
inline constexpr std::string_view kLeftOutElements =
    " visual statistic size text tuple sensor keyframe actuator deformable extension flag "
    "lengthrange camera light pair material texture hfield skin model spatial distance flex "
    "flexvert flexstrain ";

/// Elements of <actuator>: left out, too, but for what drives.h keeps of them.
inline constexpr std::string_view kActuators =
    " general motor position velocity intvelocity orientation pid damper cylinder muscle adhesion "
    "dcmotor plugin ";

/// Newer elements that would change the arm if they were left out.
inline constexpr std::string_view kUnknown[] = {"replicate", "composite", "flexcomp"};

/// The same of URDF, and where it stands.
struct KeptOfUrdf : Kept {
  std::string_view within;  ///< elements, as in Kept::attributes
};
inline constexpr KeptOfUrdf kUrdf[] = {
    {{"link", " name type "}, " robot "},
    {{"inertial", " "}, " link "},
    {{"origin", " xyz rpy "}, " inertial joint "},
    {{"mass", " value "}, " inertial "},
    {{"inertia", " ixx ixy ixz iyy iyz izz "}, " inertial "},
    {{"joint", " name type "}, " robot "},
    {{"parent", " link "}, " joint "},
    {{"child", " link "}, " joint "},
    {{"axis", " xyz "}, " joint "},
    {{"limit", " lower upper effort velocity acceleration jerk "}, " joint "},
    {{"dynamics", " damping friction armature "}, " joint "},  // armature: ours
    {{"mimic", " joint multiplier offset "}, " joint "},
};
/// Elements of these that are left out, as are those of a namespace; any other one is an error.
inline constexpr std::string_view kUrdfLeftOut =
    " visual collision contact material gazebo sensor self_collision_checking verbose calibration "
    "safety_controller ";

}  // namespace tauext::detail
