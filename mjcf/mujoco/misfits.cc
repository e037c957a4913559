// SPDX-License-Identifier: Apache-2.0
#include "mjcf/mujoco/misfits.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstddef>
#include <stdexcept>

#include "mjcf/mujoco/mujoco_functions.h"
#include "mjcf/mujoco/ties.h"
#include "mjcf/trace/printable.h"

namespace tauext {
namespace {

bool is_hinge_or_slide(const mjModel& m, int joint) {
  return m.jnt_type[joint] == mjJNT_HINGE || m.jnt_type[joint] == mjJNT_SLIDE;
}

void add_free(const mjModel& m, std::vector<Misfit>& all) {
  std::vector<std::string> words;
  std::vector<int> joints;
  for (int i = 0; i < m.njnt; ++i) {
    if (is_hinge_or_slide(m, i)) continue;
    words.push_back(
        fmt::format("{} is {}", joint_name(m, i), m.jnt_type[i] == mjJNT_FREE ? "free" : "a ball"));
    joints.push_back(i);
  }
  if (!joints.empty())
    all.push_back(
        {fmt::format("{}: an arm of hinges and slides on a fixed base is wanted; --lock REGEX "
                     "fixes such joints",
                     fmt::join(words, ", ")),
         joints});
}

// a spring whose joint an equality holds does nothing
void add_springs(const mjModel& m, const Ties& ties, std::vector<Misfit>& all) {
  std::vector<std::string> words;
  std::vector<int> joints;
  for (int i = 0; i < m.njnt; ++i) {
    if (m.jnt_stiffness[i] == 0) continue;
    const int dof = m.jnt_dofadr[i];
    if (ties.T.rows() > dof && ties.T.row(dof).isZero(0)) continue;
    words.push_back(fmt::format("{} has a spring of {:.4g} {}", joint_name(m, i),
                                m.jnt_stiffness[i],
                                m.jnt_type[i] == mjJNT_SLIDE ? "N/m" : "N m/rad"));
    joints.push_back(i);
  }
  if (!joints.empty())
    all.push_back({fmt::format("{}, which no estimator here knows: take the stiffness out, or "
                               "--lock REGEX fixes such joints",
                               fmt::join(words, ", ")),
                   joints});
}

void add_tendon(const mjModel& m, int tendon, std::vector<int>& joints) {
  for (int k = 0; k < m.tendon_num[tendon]; ++k) {
    const int at = m.tendon_adr[tendon] + k;
    if (m.wrap_type[at] == mjWRAP_JOINT) joints.push_back(m.wrap_objid[at]);
  }
}

void add_tendons(const mjModel& m, std::vector<Misfit>& all) {
  Misfit forces{"the model has tendons with springs or friction: take these out", {}};
  bool found = false;
  for (int t = 0; t < m.ntendon; ++t) {
    if (m.tendon_stiffness[t] == 0 && m.tendon_damping[t] == 0 && m.tendon_frictionloss[t] == 0)
      continue;
    found = true;
    add_tendon(m, t, forces.joints);
  }
  if (found) all.push_back(forces);
}

// of a ring that two bodies close: on the way from one to the other
void add_ring(const mjModel& m, int one, int two, std::vector<int>& joints) {
  if (std::max(one, two) >= m.nbody) return;  // numbers of sites, as newer MuJoCo has them
  while (one != two) {                        // a body's number is above that of what carries it
    int& deeper = one > two ? one : two;
    for (int k = 0; k < m.body_jntnum[deeper]; ++k) joints.push_back(m.body_jntadr[deeper] + k);
    deeper = m.body_parentid[deeper];
  }
}

// joints that such an equality ties; it is refused, unless it ties one straight line
void add_tied(const mjModel& m, int e, std::vector<int>& joints) {
  const int one = m.eq_obj1id[e], two = m.eq_obj2id[e];
  switch (m.eq_type[e]) {
    case mjEQ_CONNECT:
    case mjEQ_WELD:
      return add_ring(m, one, two, joints);
    case mjEQ_TENDON:
      add_tendon(m, one, joints);
      if (two >= 0) add_tendon(m, two, joints);
      return;
    case mjEQ_JOINT: {
      const double* const c = m.eq_data + mjNEQDATA * e;
      const auto same = [&](int other) {
        return other != e && is_active(m, other) && m.eq_type[other] == mjEQ_JOINT &&
               m.eq_obj1id[other] == one;
      };
      bool twice = false;
      for (int other = 0; other < m.neq; ++other) twice = twice || same(other);
      if (!twice && std::all_of(c + 2, c + 5, [](double x) { return x == 0; })) return;
      joints.push_back(one);
      if (two >= 0) joints.push_back(two);
      return;
    }
    default:
      return;
  }
}

// what of the ties is refused; `ties` becomes what they are
void add_ties(const mjModel& m, Ties& ties, std::vector<Misfit>& all) {
  try {
    ties = ties_of(m);
  } catch (const std::invalid_argument& e) {
    Misfit misfit{e.what(), {}};
    for (int i = 0; i < m.neq; ++i)
      if (is_active(m, i)) add_tied(m, i, misfit.joints);
    all.push_back(misfit);
  }
}

// that MuJoCo would leave out, and an ArmTree has
void add_switched_off(const mjModel& m, std::vector<Misfit>& all) {
  if ((m.opt.disableflags & kSimulated) != 0) return;  // by ourselves
  const auto add = [&](const char* what, bool is_there) {
    if (is_there)
      all.push_back(
          {fmt::format("<flag> switches off {0}, which joints have: take the flag out, or "
                       "the {0}",
                       what),
           {}});
  };
  const int off = m.opt.disableflags;
  add("damping", is_undamped(m) && any(m.dof_damping, m.nv));
  add("frictionloss",
      (off & (mjDSBL_FRICTIONLOSS | mjDSBL_CONSTRAINT)) != 0 && any(m.dof_frictionloss, m.nv));
  add("equality", (off & mjDSBL_CONSTRAINT) != 0 && has_ties(m));
}

}  // namespace

std::vector<Misfit> misfits_of(const mjModel& m) {
  std::vector<Misfit> all;
  add_free(m, all);
  Ties ties;
  std::vector<Misfit> of_ties;
  add_ties(m, ties, of_ties);
  add_springs(m, ties, all);
  if (m.nv == 0)
    all.push_back({"no joint is left that moves: an arm of hinges and slides is wanted", {}});
  all.insert(all.end(), of_ties.begin(), of_ties.end());
  add_tendons(m, all);
  add_switched_off(m, all);
  if (has_powers(m))
    all.push_back(
        {"joints have springs or damping of higher powers, and only straight lines are known", {}});
  if (m.opt.density != 0 || m.opt.viscosity != 0)
    all.push_back(
        {"the model has air or water around it: take density and viscosity out of <option>", {}});
  return all;
}

std::string in_words(const std::vector<Misfit>& misfits) {
  std::vector<std::string> words;
  for (const Misfit& m : misfits) words.push_back(m.words);
  return one_line(fmt::format("{}", fmt::join(words, "; ")), 8000);
}

}  // namespace tauext
