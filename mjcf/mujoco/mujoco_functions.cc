// SPDX-License-Identifier: Apache-2.0
#include "mjcf/mujoco/mujoco_functions.h"

#include <dlfcn.h>
#include <fmt/format.h>

#include <stdexcept>

namespace tauext::detail {
namespace {

// where the linker looks, else where it was when this was built; a library that exports a tinyxml2
// of its own shall not take ours for it
void* library() {
#ifdef TAUEXT_SANITIZED  // which refuses that
  constexpr int kBinding = RTLD_NOW;
#else
  constexpr int kBinding = RTLD_NOW | RTLD_DEEPBIND;
#endif
  if (void* const found = ::dlopen(TAUEXT_MUJOCO_NAME, kBinding)) return found;
  if (void* const found = ::dlopen(TAUEXT_MUJOCO_PATH, kBinding)) return found;
  throw std::runtime_error(fmt::format(
      "MuJoCo, which simulates and reads robots' files, cannot be loaded: {}; install "
      "MuJoCo " TAUEXT_MUJOCO_VERSION " (Debian and Ubuntu: libmujoco" TAUEXT_MUJOCO_VERSION
      "), or set LD_LIBRARY_PATH to the "
      "folder of " TAUEXT_MUJOCO_NAME,
      ::dlerror()));
}

template <class Pointer>
void find(void* from, const char* name, Pointer& pointer) {
  pointer = reinterpret_cast<Pointer>(::dlsym(from, name));
  if (pointer == nullptr)
    throw std::runtime_error(fmt::format(TAUEXT_MUJOCO_NAME " has no {}: is it MuJoCo?", name));
}

MujocoFunctions loaded() {
  void* const from = library();
  MujocoFunctions f{};
  // the layout of its structures goes with its version
  find(from, "mj_version", f.mj_version);
  find(from, "mj_versionString", f.mj_versionString);
  if (f.mj_version() != mjVERSION_HEADER) {
    throw std::runtime_error(
        fmt::format(TAUEXT_MUJOCO_NAME
                    " is MuJoCo {}, and this was built with the headers of " TAUEXT_MUJOCO_VERSION
                    "; build with -DMuJoCo_ROOT=FOLDER of the one you have, "
                    "or set LD_LIBRARY_PATH to the folder of the other",
                    f.mj_versionString()));
  }
#define TAUEXT_FIND(name) find(from, #name, f.name);
  TAUEXT_MUJOCO_FUNCTIONS(TAUEXT_FIND)
  TAUEXT_MUJOCO_HOOKS(TAUEXT_FIND)
#undef TAUEXT_FIND
  return f;
}

}  // namespace

const MujocoFunctions& mujoco() {
  static const MujocoFunctions functions = loaded();
  return functions;
}

}  // namespace tauext::detail
