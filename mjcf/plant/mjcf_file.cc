// SPDX-License-Identifier: Apache-2.0
#include "mjcf/plant/mjcf_file.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <mutex>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "mjcf/import/mendable.h"
#include "mjcf/mujoco/mujoco_functions.h"
#include "mjcf/mujoco/ties.h"
#include "mjcf/plant/remedy/remedy.h"
#include "mjcf/trace/printable.h"

namespace tauext {
namespace {

// MuJoCo's own handler writes a log file, waits for a key and exits; its callbacks are global
[[noreturn]] void throw_error(const char* message) {
  throw std::runtime_error(fmt::format("MuJoCo: {}", message));
}

// warnings are counted in mjData, where Plant::step looks for them
void ignore_warning(const char*) {}

std::string element(const mjModel& m, mjtObj type, std::string_view kind, int id) {
  const std::string name = element_name(m, type, id);
  return name.empty() ? fmt::format("{} {}", kind, id) : fmt::format("{} '{}'", kind, name);
}

// numbers of a kind of elements, by MJCF's name, and the limits of what a machine can have
struct Numbers {
  mjtObj type;
  const char* kind;
  std::int64_t elements;
  const char* attribute;
  const mjtNum* values;
  int width;  // numbers of an element
  double least, most;
  const int* of = nullptr;  // the element that each belongs to, if not its own number
};

constexpr double kAny = mjMAXVAL;  // beyond it MuJoCo takes a state for a wrong one

std::string range_of(double least, double most) {
  return most == kAny && least == -kAny ? "finite" : fmt::format("{:g} to {:g}", least, most);
}

// in words, and what mends them: a joint whose numbers are too large can be locked
struct Problems {
  std::vector<std::string> words;
  Mending by;
};

void check_numbers(const mjModel& m, const Numbers& n, Problems& problems) {
  for (int i = 0; i < n.elements * n.width; ++i) {
    const double value = n.values[i];
    if (value >= n.least && value <= n.most) continue;
    const int id = n.of == nullptr ? i / n.width : n.of[i / n.width];
    std::string problem =
        fmt::format("{}: {} is {:g}, and must be {}", element(m, n.type, n.kind, id), n.attribute,
                    value, range_of(n.least, n.most));
    if (problems.words.empty() || problems.words.back() != problem)
      problems.words.push_back(std::move(problem));
    const char* const name = n.type == mjOBJ_JOINT ? mj_id2name(&m, n.type, id) : nullptr;
    if (name != nullptr && value > n.most) problems.by.lock.insert(name);
  }
}

void check_option(const char* what, double value, double least, double most, Problems& problems) {
  if (value >= least && value <= most) return;
  problems.words.push_back(
      fmt::format("option: {} is {:g}, and must be {}", what, value, range_of(least, most)));
}

// MuJoCo scales what it can to length 1
void check_turn(const mjModel& m, const char* attribute, const mjtNum* quaternions,
                Problems& problems) {
  for (int i = 0; i < m.nbody; ++i) {
    const double length = mju_norm(quaternions + 4 * i, 4);
    if (std::abs(length - 1) < 1e-6) continue;
    problems.words.push_back(fmt::format("{}: {} has the length {:g}, and must turn",
                                         element(m, mjOBJ_BODY, "body", i), attribute, length));
  }
}

void check_physical(const mjModel& m) {
  constexpr auto kJoint = mjOBJ_JOINT, kTendon = mjOBJ_TENDON, kBody = mjOBJ_BODY,
                 kSite = mjOBJ_SITE, kMotor = mjOBJ_ACTUATOR;
  constexpr double kMuch = 1e6;  // [kg, N m, N m s/rad, ..]
  Problems problems;
  for (const double g : m.opt.gravity) check_option("gravity", g, -1000, 1000, problems);
  check_option("timestep", m.opt.timestep, 1e-9, 1, problems);
  // a step must not take minutes
  check_option("iterations", m.opt.iterations, 0, 1000, problems);
  check_option("noslip_iterations", m.opt.noslip_iterations, 0, 1000, problems);
  const auto [name, most] = collision_iterations(m);
  check_option(name, most, 0, 1000, problems);
  for (const Numbers& n : std::to_array<Numbers>({
           {kBody, "body", m.nbody, "mass", m.body_mass, 1, 0, kMuch},
           {kBody, "body", m.nbody, "diaginertia", m.body_inertia, 3, 0, 1e9},
           {kBody, "body", m.nbody, "pos", m.body_pos, 3, -kMuch, kMuch},
           {kBody, "body", m.nbody, "inertial pos", m.body_ipos, 3, -kMuch, kMuch},
           {kSite, "site", m.nsite, "pos", m.site_pos, 3, -kMuch, kMuch},
           {kSite, "site", m.nsite, "quat", m.site_quat, 4, -kAny, kAny},
           {kJoint, "joint", m.nv, "armature", m.dof_armature, 1, 0, kMuch, m.dof_jntid},
           {kJoint, "joint", m.nv, "damping", m.dof_damping, 1, 0, kMuch, m.dof_jntid},
           {kJoint, "joint", m.nv, "frictionloss", m.dof_frictionloss, 1, 0, kMuch, m.dof_jntid},
           {kJoint, "joint", m.njnt, "stiffness", m.jnt_stiffness, 1, 0, 1e9},
           {kJoint, "joint", m.njnt, "axis", m.jnt_axis, 3, -kAny, kAny},
           {kJoint, "joint", m.njnt, "pos", m.jnt_pos, 3, -kMuch, kMuch},
           {kJoint, "joint", m.njnt, "range", m.jnt_range, 2, -kAny, kAny},
           {kJoint, "joint", m.njnt, "solreflimit", m.jnt_solref, mjNREF, -kAny, kAny},
           {kJoint, "joint", m.nv, "solreffriction", m.dof_solref, mjNREF, -kAny, kAny,
            m.dof_jntid},
           {kTendon, "tendon", m.ntendon, "stiffness", m.tendon_stiffness, 1, 0, 1e9},
           {kTendon, "tendon", m.ntendon, "damping", m.tendon_damping, 1, 0, kMuch},
           {kTendon, "tendon", m.ntendon, "frictionloss", m.tendon_frictionloss, 1, 0, kMuch},
           {mjOBJ_EQUALITY, "equality", m.neq, "polycoef", m.eq_data, mjNEQDATA, -kMuch, kMuch},
           {kMotor, "actuator", m.nu, "gear", m.actuator_gear, 6, -kAny, kAny},
           {kMotor, "actuator", m.nu, "ctrlrange", m.actuator_ctrlrange, 2, -kAny, kAny},
           {kMotor, "actuator", m.nu, "forcerange", m.actuator_forcerange, 2, -kAny, kAny},
           {kMotor, "actuator", m.nu, "gainprm", m.actuator_gainprm, mjNGAIN, -kAny, kAny},
           {kMotor, "actuator", m.nu, "biasprm", m.actuator_biasprm, mjNBIAS, -kAny, kAny},
       })) {
    check_numbers(m, n, problems);
  }
  check_turn(m, "quat", m.body_quat, problems);
  check_turn(m, "inertial quat", m.body_iquat, problems);
  for (int j = 0; j < m.njnt; ++j) {
    if (m.jnt_type[j] != mjJNT_HINGE && m.jnt_type[j] != mjJNT_SLIDE) continue;
    const int at = m.jnt_qposadr[j];
    check_numbers(m, {kJoint, "joint", 1, "ref", m.qpos0 + at, 1, -kAny, kAny, &j}, problems);
    check_numbers(m, {kJoint, "joint", 1, "springref", m.qpos_spring + at, 1, -kAny, kAny, &j},
                  problems);
  }
  if (!problems.words.empty())
    throw Mendable(one_line(fmt::format("{}", fmt::join(problems.words, "; ")), 8000), problems.by);
}

// a step of its own, from its initial state
void try_step(const mjModel& m) {
  const State d(mj_makeData(&m));
  mj_step(&m, d.get());
  for (int w = 0; w < mjNWARNING; ++w) {
    if (d->warning[w].number == 0 || w == mjWARN_CONTACTFULL || w == mjWARN_CNSTRFULL)
      continue;  // shapes that touch each other count for nothing here
    throw std::runtime_error(fmt::format("cannot be simulated from its initial state: {}",
                                         mju_warningText(w, d->warning[w].lastinfo)));
  }
}

// what of a message says what is wrong, not where
std::string_view without_line(std::string_view message) {
  return message.substr(0, message.rfind(", line"));
}

// whether motors drive it, and each of its joints, of which none follows another
bool has_motors(const mjModel& m) {
  for (int i = 0; i < m.nu; ++i) {
    if (m.actuator_gaintype[i] != mjGAIN_FIXED || m.actuator_biastype[i] != mjBIAS_NONE)
      return false;
  }
  return m.nu > 0 && m.nu >= m.nv && !has_ties(m);
}

// what MuJoCo says, with a remedy, and without mjMINVAL, which is no word of a user's
std::string without_jargon(const std::string& message) {
  for (const char* const missing : {"could not open", "Cannot open file", "Error opening file"})
    if (message.find(missing) != message.npos)
      return message +
             "; get that file, or write an <inertial> into the bodies whose mass is that of its "
             "mesh";
  if (message.find("mjMINVAL") == message.npos) return message;
  for (const std::string_view before : {"Object name = ", "Element name '"}) {  // MuJoCo 2, 3
    const std::size_t name = message.find(before), from = name + before.size();
    if (name == message.npos) continue;
    return fmt::format(
        "body '{}' moves, and mass or inertia of it is not above 0; give it an <inertial> with "
        "both, or find them from recordings (tauext-calibrate --masses)",
        message.substr(from, message.find(before.back() == '\'' ? "', id" : ", id", from) - from));
  }
  return message;
}

// the file as it is, or, if it has to be, imported
Model loaded(const std::string& path, const ImportOptions& options, std::string& changes) {
  std::array<char, 1000> error{};
  const bool urdf = is_urdf(path);
  Model m = urdf ? nullptr : owned(mj_loadXML(path.c_str(), nullptr, error.data(), error.size()));
  if (m && options.changes_nothing() && has_motors(*m) && !moves_as_newer(*m)) return m;
  const std::string first = one_line(error.data());
  try {
    const ImportedText text = import_mjcf(path, options);
    changes = one_line(in_words(text), 8000);
    return load_files({{"robot.xml", text.xml}});
  } catch (const Mendable&) {
    throw;
  } catch (const std::runtime_error& e) {
    for (const char* unreadable : {"problem reading attribute", "bad format in attribute"}) {
      if (std::string_view(e.what()).find(unreadable) == std::string_view::npos) continue;
      refuse_commas(path);
      refuse_nan(path);
    }
    // the same in the words that name the file's own line; those of the imported text help nobody
    if (!m && !urdf && without_line(first) == without_line(e.what()))
      throw std::runtime_error(first);
    throw std::runtime_error(std::string(without_line(e.what())));
  }
}

// imported in any case
Reading reading(const std::string& path) {
  return [path](const ImportOptions& options) {
    Model m = load_files({{"robot.xml", import_mjcf(path, options).xml}});
    check_physical(*m);
    return m;
  };
}

// the changes in a line, and MJB
std::string compiled(const std::string& path, const ImportOptions& options) {
  std::string changes;
  Model m;
  try {
    m = loaded(path, options, changes);
    check_physical(*m);
  } catch (const Mendable& e) {
    throw std::runtime_error(with_remedy(e.what(), path, options, reading(path)));
  }
  refuse_nan(path);
  try_step(*m);
  std::string bytes(static_cast<std::size_t>(mj_sizeModel(m.get())), '\0');
  mj_saveModel(m.get(), nullptr, bytes.data(), static_cast<int>(bytes.size()));
  return changes + '\n' + bytes;
}

}  // namespace

void throw_mujoco_errors() {
  static std::once_flag once;
  std::call_once(once, [] {
    *detail::mujoco().mju_user_error = throw_error;
    *detail::mujoco().mju_user_warning = ignore_warning;
  });
}

Model load_files(const std::vector<std::pair<std::string, std::string_view>>& files) {
  // it holds a fixed table, and so lives on the heap
  const std::unique_ptr<mjVFS, void (*)(mjVFS*)> vfs(new mjVFS, [](mjVFS* v) {
    mj_deleteVFS(v);
    delete v;
  });
  mj_defaultVFS(vfs.get());
  for (const auto& [name, text] : files) {
    if (!add_file(*vfs, name, text))
      throw std::runtime_error(fmt::format("{}: MuJoCo's file table is full", name));
  }
  const std::string& main = files.front().first;
  std::array<char, 1000> error{"MuJoCo cannot read its own binary form"};
  mjModel* const m = main.ends_with(".mjb")
                         ? mj_loadModel(main.c_str(), vfs.get())
                         : mj_loadXML(main.c_str(), vfs.get(), error.data(), error.size());
  if (m == nullptr) throw std::runtime_error(one_line(error.data()));
  return owned(m);
}

std::string compiled_mjcf(const std::string& path, const Limits& limits,
                          const ImportOptions& options, std::string* changes) {
  throw_mujoco_errors();
  try {
    const std::string all = confined(limits, [&] { return compiled(path, options); });
    const std::size_t end = all.find('\n');
    if (changes != nullptr) *changes = all.substr(0, end);
    return all.substr(end + 1);
  } catch (const Unfinished& e) {
    throw std::runtime_error(
        fmt::format("{}: MuJoCo {} when it loads this robot. Textures can be left out, and meshes "
                    "where every body has an <inertial>; each <include> must name a file",
                    path, e.what()));
  } catch (const std::runtime_error& e) {
    throw std::runtime_error(fmt::format("{}: {}", path, without_jargon(e.what())));
  }
}

std::string why_no_arm(const std::string& why, const std::string& path, const Limits& limits,
                       const ImportOptions& options) {
  throw_mujoco_errors();
  try {
    return confined(limits, [&] { return with_remedy(why, path, options, reading(path)); });
  } catch (const std::runtime_error&) {
    return why;
  }
}

}  // namespace tauext
