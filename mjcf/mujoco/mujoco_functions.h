// SPDX-License-Identifier: Apache-2.0
/// @file
/// MuJoCo's functions, from a library that is loaded when one of them is first called: a program
/// that simulates nothing runs where MuJoCo is not installed. The sources that call MuJoCo include
/// this instead of MuJoCo's header; calls are written as with that.
#pragma once

#include <mujoco/mujoco.h>

#include <utility>

namespace tauext {
namespace detail {

// functions that are called
// clang-format off
#define TAUEXT_MUJOCO_FUNCTIONS(name) \
  name(mj_RungeKutta) name(mj_contactForce) name(mj_copyModel) name(mj_defaultVFS) \
  name(mj_deleteData) name(mj_deleteModel) name(mj_deleteVFS) name(mj_forward) \
  name(mj_forwardSkip) name(mj_fullM) name(mj_fwdActuation) name(mj_fwdPosition) \
  name(mj_fwdVelocity) name(mj_id2name) name(mj_isSparse) name(mj_jac) name(mj_loadModel) \
  name(mj_loadXML) name(mj_makeData) name(mj_makeEmptyFileVFS) name(mj_name2id) \
  name(mj_resetData) name(mj_saveModel) name(mj_setConst) name(mj_sizeModel) name(mj_step) \
  name(mj_version) name(mj_versionString) name(mju_norm) name(mju_warningText)

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

}  // namespace tauext
