// SPDX-License-Identifier: Apache-2.0
#include "mjcf/mujoco/mujoco_functions.h"

#include <dlfcn.h>
#include <fmt/format.h>

#include <stdexcept>

namespace tauext::detail {
namespace {

// where the linker looks, else where it was when this was built
void* library() {
  if (void* const found = ::dlopen(TAUEXT_MUJOCO_NAME, RTLD_NOW)) return found;
  if (void* const found = ::dlopen(TAUEXT_MUJOCO_PATH, RTLD_NOW)) return found;
  throw std::runtime_error(fmt::format(
      "MuJoCo, which simulates and reads robots' files, cannot be loaded: {}; install "
      "Debian's libmujoco2.2.2, or set LD_LIBRARY_PATH to the folder of " TAUEXT_MUJOCO_NAME,
      ::dlerror()));
}

template <class Pointer>
void find(void* from, const char* name, Pointer& pointer) {
  pointer = reinterpret_cast<Pointer>(::dlsym(from, name));
  if (pointer == nullptr)
    throw std::runtime_error(fmt::format(TAUEXT_MUJOCO_NAME " has no {}: is it 2.2.2?", name));
}

MujocoFunctions loaded() {
  void* const from = library();
  MujocoFunctions f{};
#define TAUEXT_FIND(name) find(from, #name, f.name);
  TAUEXT_MUJOCO_FUNCTIONS(TAUEXT_FIND)
  TAUEXT_MUJOCO_HOOKS(TAUEXT_FIND)
#undef TAUEXT_FIND
  // the layout of its structures goes with its version
  if (f.mj_version() != mjVERSION_HEADER)
    throw std::runtime_error(fmt::format(TAUEXT_MUJOCO_NAME " is version {}, and {} is wanted",
                                         f.mj_version(), mjVERSION_HEADER));
  return f;
}

}  // namespace

const MujocoFunctions& mujoco() {
  static const MujocoFunctions functions = loaded();
  return functions;
}

}  // namespace tauext::detail
