// SPDX-License-Identifier: Apache-2.0
#include "mjcf/model.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <mutex>
#include <stdexcept>
#include <utility>

#include "mjcf/robots.h"

namespace tauext {
namespace {

// MuJoCo's own handler writes a log file, waits for a key and exits; its callbacks are global
[[noreturn]] void throw_error(const char* message) {
  throw std::runtime_error(fmt::format("MuJoCo: {}", message));
}

// warnings are counted in mjData, where Plant::step looks for them
void ignore_warning(const char*) {}

void install_handlers() {
  static std::once_flag once;
  std::call_once(once, [] {
    mju_user_error = throw_error;
    mju_user_warning = ignore_warning;
  });
}

Model own(mjModel* m) {
  return Model(m, [](const mjModel* p) { mj_deleteModel(const_cast<mjModel*>(p)); });
}

// the virtual file system of mj_loadXML, which holds a fixed table and so lives on the heap
struct Vfs {
  Vfs() { mj_defaultVFS(vfs.get()); }
  ~Vfs() { mj_deleteVFS(vfs.get()); }
  Vfs(const Vfs&) = delete;
  Vfs& operator=(const Vfs&) = delete;
  std::unique_ptr<mjVFS> vfs = std::make_unique<mjVFS>();
};

}  // namespace

std::string mujoco_version() {
  return mj_versionString();
}

std::vector<std::string> robot_names() {
  std::vector<std::string> names;
  for (const EmbeddedRobot& r : kEmbeddedRobots) names.emplace_back(r.name);
  return names;
}

Model load_robot(std::string_view name) {
  install_handlers();
  for (const EmbeddedRobot& r : kEmbeddedRobots) {
    if (r.name != name) continue;
    Vfs files;
    const std::string file = fmt::format("{}.xml", name);
    const int size = static_cast<int>(r.xml.size());
    if (mj_makeEmptyFileVFS(files.vfs.get(), file.c_str(), size) != 0) {
      throw std::runtime_error(fmt::format("{}: MuJoCo's file table is full", file));
    }
    std::copy(r.xml.begin(), r.xml.end(),
              static_cast<char*>(files.vfs->filedata[files.vfs->nfile - 1]));
    char error[1000] = "";
    mjModel* m = mj_loadXML(file.c_str(), files.vfs.get(), error, sizeof error);
    if (m == nullptr) throw std::runtime_error(fmt::format("{}: {}", file, error));
    return own(m);
  }
  throw std::invalid_argument(
      fmt::format("unknown robot '{}'; known: {}", name, fmt::join(robot_names(), ", ")));
}

Model with_scaled_body(const Model& model, const std::string& body, double factor) {
  const int id = mj_name2id(model.get(), mjOBJ_BODY, body.c_str());
  if (id < 0) throw std::invalid_argument(fmt::format("the robot has no body '{}'", body));
  if (!(factor > 0) || !std::isfinite(factor)) {
    throw std::invalid_argument(
        fmt::format("body '{}': a mass factor must be positive, not {}", body, factor));
  }
  mjModel* m = mj_copyModel(nullptr, model.get());
  m->body_mass[id] *= factor;
  for (int i = 0; i < 3; ++i) m->body_inertia[3 * id + i] *= factor;
  const std::unique_ptr<mjData, decltype(&mj_deleteData)> d(mj_makeData(m), mj_deleteData);
  mj_setConst(m, d.get());
  return own(m);
}

Model wallmobot3_with_panel(double panel) {
  constexpr double kLink5 = 177, kPanel = 150;  // [kg] Table II
  return with_scaled_body(load_robot("wallmobot3"), "link5", (kLink5 - kPanel + panel) / kLink5);
}

}  // namespace tauext
