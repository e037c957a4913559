// SPDX-License-Identifier: Apache-2.0
#include "mjcf/plant/mjcf_file.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <mutex>
#include <stdexcept>
#include <string_view>

namespace tauext {
namespace {

// MuJoCo's own handler writes a log file, waits for a key and exits; its callbacks are global
[[noreturn]] void throw_error(const char* message) {
  throw std::runtime_error(fmt::format("MuJoCo: {}", message));
}

// warnings are counted in mjData, where Plant::step looks for them
void ignore_warning(const char*) {}

using Owned = std::unique_ptr<mjModel, decltype(&mj_deleteModel)>;

// MuJoCo's lines as one
std::string one_line(std::string_view text) {
  std::string line;
  for (const char c : text) {
    if (c != '\n') {
      line += c;
    } else if (!line.empty() && !line.ends_with("; ")) {
      line += "; ";
    }
  }
  if (line.ends_with("; ")) line.resize(line.size() - 2);
  return line;
}

std::string element(const mjModel& m, mjtObj type, std::string_view kind, int id) {
  const char* const name = mj_id2name(&m, type, id);
  return name != nullptr && *name != '\0' ? fmt::format("{} '{}'", kind, name)
                                          : fmt::format("{} {}", kind, id);
}

// numbers of a kind of elements, by MJCF's name
struct Numbers {
  mjtObj type;
  const char* kind;
  int elements;
  const char* attribute;
  const mjtNum* values;
  int width;                // numbers of an element
  bool signed_;             // may be negative
  const int* of = nullptr;  // the element that each belongs to, if not its own number
};

void check_numbers(const mjModel& m, const Numbers& n) {
  for (int i = 0; i < n.elements * n.width; ++i) {
    const double value = n.values[i];
    if (std::isfinite(value) && (n.signed_ || value >= 0)) continue;
    const int id = i / n.width;
    throw std::runtime_error(
        fmt::format("{}: {} is {:g}, and must be {}",
                    element(m, n.type, n.kind, n.of == nullptr ? id : n.of[id]), n.attribute, value,
                    n.signed_ ? "finite" : "0 or more"));
  }
}

void check_physical(const mjModel& m) {
  constexpr auto kJoint = mjOBJ_JOINT, kTendon = mjOBJ_TENDON, kBody = mjOBJ_BODY,
                 kMotor = mjOBJ_ACTUATOR;
  for (const double g : m.opt.gravity) {
    if (!std::isfinite(g)) throw std::runtime_error(fmt::format("option: gravity is {:g}", g));
  }
  if (!(m.opt.timestep > 0 && std::isfinite(m.opt.timestep))) {
    throw std::runtime_error(
        fmt::format("option: timestep is {:g} s, and must be positive", m.opt.timestep));
  }
  for (const Numbers& n : std::to_array<Numbers>({
           {kBody, "body", m.nbody, "mass", m.body_mass, 1, false},
           {kBody, "body", m.nbody, "inertia", m.body_inertia, 3, false},
           {kBody, "body", m.nbody, "pos", m.body_pos, 3, true},
           {kBody, "body", m.nbody, "quat", m.body_quat, 4, true},
           {kBody, "body", m.nbody, "centre of mass", m.body_ipos, 3, true},
           {kJoint, "joint", m.nv, "armature", m.dof_armature, 1, false, m.dof_jntid},
           {kJoint, "joint", m.nv, "damping", m.dof_damping, 1, false, m.dof_jntid},
           {kJoint, "joint", m.nv, "frictionloss", m.dof_frictionloss, 1, false, m.dof_jntid},
           {kJoint, "joint", m.njnt, "stiffness", m.jnt_stiffness, 1, false},
           {kJoint, "joint", m.njnt, "axis", m.jnt_axis, 3, true},
           {kJoint, "joint", m.njnt, "pos", m.jnt_pos, 3, true},
           {kJoint, "joint", m.njnt, "range", m.jnt_range, 2, true},
           {kTendon, "tendon", m.ntendon, "stiffness", m.tendon_stiffness, 1, false},
           {kTendon, "tendon", m.ntendon, "damping", m.tendon_damping, 1, false},
           {kTendon, "tendon", m.ntendon, "frictionloss", m.tendon_frictionloss, 1, false},
           {kMotor, "actuator", m.nu, "gear", m.actuator_gear, 6, true},
           {kMotor, "actuator", m.nu, "gainprm", m.actuator_gainprm, mjNGAIN, true},
           {kMotor, "actuator", m.nu, "biasprm", m.actuator_biasprm, mjNBIAS, true},
       })) {
    check_numbers(m, n);
  }
}

// a step of its own, from its initial state
void try_step(const mjModel& m) {
  const std::unique_ptr<mjData, decltype(&mj_deleteData)> d(mj_makeData(&m), mj_deleteData);
  mj_step(&m, d.get());
  for (int w = 0; w < mjNWARNING; ++w) {
    if (d->warning[w].number == 0) continue;
    throw std::runtime_error(fmt::format("cannot be simulated from its initial state: {}",
                                         mju_warningText(w, d->warning[w].lastinfo)));
  }
}

std::string compiled(const std::string& path) {
  std::array<char, 1000> error{};
  const Owned m(mj_loadXML(path.c_str(), nullptr, error.data(), error.size()), mj_deleteModel);
  if (!m) throw std::runtime_error(one_line(error.data()));
  check_physical(*m);
  try_step(*m);
  std::string bytes(static_cast<std::size_t>(mj_sizeModel(m.get())), '\0');
  mj_saveModel(m.get(), nullptr, bytes.data(), static_cast<int>(bytes.size()));
  return bytes;
}

}  // namespace

void throw_mujoco_errors() {
  static std::once_flag once;
  std::call_once(once, [] {
    mju_user_error = throw_error;
    mju_user_warning = ignore_warning;
  });
}

std::string compiled_mjcf(const std::string& path, const Limits& limits) {
  throw_mujoco_errors();
  try {
    return confined(limits, [&] { return compiled(path); });
  } catch (const Unfinished& e) {
    throw std::runtime_error(
        fmt::format("{}: MuJoCo {} while it loads it; leave out what dynamics does not need "
                    "(textures, meshes), and includes that are no files",
                    path, e.what()));
  } catch (const std::runtime_error& e) {
    throw std::runtime_error(fmt::format("{}: {}", path, e.what()));
  }
}

}  // namespace tauext
