// SPDX-License-Identifier: Apache-2.0
/// @file
/// MuJoCo's functions, from a library that is loaded when one of them is first called: a program
/// that simulates nothing runs where MuJoCo is not installed. The sources that call MuJoCo include
/// this instead of MuJoCo's header; calls are written as with that. At the end what its versions,
/// 2.2.2 to 3.12, name differently.
#pragma once

#include <mujoco/mujoco.h>

#include <Eigen/Core>
#include <algorithm>
#include <string>
#include <string_view>
#include <utility>

namespace tauext {
namespace detail {

// functions that are called
// clang-format off
#define TAUEXT_MUJOCO_FUNCTIONS(name) \
  name(mj_RungeKutta) name(mj_contactForce) name(mj_copyModel) name(mj_defaultVFS) \
  name(mj_deleteData) name(mj_deleteModel) name(mj_deleteVFS) name(mj_forward) \
  name(mj_forwardSkip) name(mj_fwdActuation) name(mj_fwdPosition) name(mj_fwdVelocity) \
  name(mj_id2name) name(mj_isSparse) name(mj_jac) name(mj_loadModel) name(mj_loadXML) \
  name(mj_makeData) name(mj_mulM) name(mj_name2id) name(mj_resetData) name(mj_saveModel) \
  name(mj_setConst) name(mj_sizeModel) name(mj_step) name(mj_version) name(mj_versionString) \
  name(mju_norm) name(mju_warningText) TAUEXT_MUJOCO_FILES(name)

#if mjVERSION_HEADER < 320
#define TAUEXT_MUJOCO_FILES(name) name(mj_makeEmptyFileVFS)
#else
#define TAUEXT_MUJOCO_FILES(name) name(mj_addBufferVFS)
#endif

// function pointers that are set
#define TAUEXT_MUJOCO_HOOKS(name) \
  name(mju_user_error) name(mju_user_warning) name(mjcb_passive) name(mjcb_control)
// clang-format on

/// Their addresses in the loaded library.
struct MujocoFunctions {
#define TAUEXT_POINTER(name) decltype(&::name) name;  // NOLINT(bugprone-macro-parentheses)
  TAUEXT_MUJOCO_FUNCTIONS(TAUEXT_POINTER)
  TAUEXT_MUJOCO_HOOKS(TAUEXT_POINTER)
#undef TAUEXT_POINTER
};

/// @throws std::runtime_error if the library cannot be loaded, saying which, why and the remedy
const MujocoFunctions& mujoco();

/// A function object, which stands before MuJoCo's function of the same name.
template <auto Function>
struct MujocoCall {
  template <class... Args>
  auto operator()(Args&&... args) const {
    return (mujoco().*Function)(std::forward<Args>(args)...);
  }
};

}  // namespace detail

#define TAUEXT_CALL(name) inline constexpr detail::MujocoCall<&detail::MujocoFunctions::name> name;
TAUEXT_MUJOCO_FUNCTIONS(TAUEXT_CALL)
#undef TAUEXT_CALL

/// Puts a file into MuJoCo's table of files. @returns whether there was room
inline bool add_file(mjVFS& files, const std::string& name, std::string_view text) {
  const int size = static_cast<int>(text.size());
#if mjVERSION_HEADER < 320
  if (mj_makeEmptyFileVFS(&files, name.c_str(), size) != 0) return false;
  std::copy(text.begin(), text.end(), static_cast<char*>(files.filedata[files.nfile - 1]));
  return true;
#else
  return mj_addBufferVFS(&files, name.c_str(), text.data(), size) == 0;
#endif
}

/// How an actuator's length grows with each degree of freedom, nv numbers.
inline Eigen::VectorXd levers(const mjModel& m, const mjData& d, int actuator) {
#if mjVERSION_HEADER < 325
  return Eigen::VectorXd::Map(d.actuator_moment + actuator * m.nv, m.nv);
#else
  Eigen::VectorXd all = Eigen::VectorXd::Zero(m.nv);
  for (int i = 0; i < d.moment_rownnz[actuator]; ++i) {
    const int k = d.moment_rowadr[actuator] + i;
    all[d.moment_colind[k]] = d.actuator_moment[k];
  }
  return all;
#endif
}

/// Whether an equality holds in the initial state.
inline bool is_active(const mjModel& m, int equality) {
#if mjVERSION_HEADER < 300
  return m.eq_active[equality] != 0;
#else
  return m.eq_active0[equality] != 0;
#endif
}

/// How often MuJoCo goes on to look where convex shapes touch, at most; and the option's name.
inline std::pair<const char*, int> collision_iterations(const mjModel& m) {
#if mjVERSION_HEADER < 323
  return {"mpr_iterations", m.opt.mpr_iterations};
#else
  return {"ccd_iterations", m.opt.ccd_iterations};
#endif
}

/// Whether one of these is not 0.
inline bool any(const auto* of, int count) {
  return std::any_of(of, of + count, [](auto x) { return x != 0; });
}

/// Whether a flag switches the damping of joints off.
inline bool is_undamped(const mjModel& m) {
#if mjVERSION_HEADER < 336
  return (m.opt.disableflags & mjDSBL_PASSIVE) != 0;
#else
  return (m.opt.disableflags & mjDSBL_DAMPER) != 0;
#endif
}

/// Whether springs or damping of joints grow with higher powers.
inline bool has_powers([[maybe_unused]] const mjModel& m) {
#if mjVERSION_HEADER < 370
  return false;
#else
  return any(m.jnt_stiffnesspoly, m.njnt * mjNPOLY) || any(m.dof_dampingpoly, m.nv * mjNPOLY);
#endif
}

/// Whether it has what 2.2.2 does not read in a file, and what changes how the arm moves.
inline bool moves_as_newer([[maybe_unused]] const mjModel& m) {
#if mjVERSION_HEADER < 300
  return false;
#else
  return m.opt.integrator > mjINT_IMPLICIT || any(m.body_gravcomp, m.nbody) ||
         any(m.jnt_actfrclimited, m.njnt);
#endif
}

}  // namespace tauext
