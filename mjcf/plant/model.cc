// SPDX-License-Identifier: Apache-2.0
#include "mjcf/plant/model.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>
#include <utility>

#include "mjcf/import/robot_file.h"
#include "mjcf/mujoco/mujoco_functions.h"
#include "mjcf/plant/mjcf_file.h"
#include "mjcf/plant/robots.h"
#include "mjcf/trace/input_file.h"
#include "mjcf/trace/known.h"

namespace tauext {
namespace {

// the text of an embedded file
template <class Files>
std::string_view embedded(const Files& files, const char* what, std::string_view name) {
  return find_known(files, what, name, [](const EmbeddedFile& f) { return f.name; }).xml;
}

// robots that came from files
std::map<std::string, Model, std::less<>>& registered() {
  static std::map<std::string, Model, std::less<>> all;
  return all;
}

}  // namespace

std::vector<std::string> robot_names() {
  std::vector<std::string> names;
  for (const EmbeddedFile& r : kEmbeddedRobots) names.emplace_back(r.name);
  for (const auto& [name, model] : registered()) names.push_back(name);
  return names;
}

Model load_robot(std::string_view name, std::string_view scene) {
  throw_mujoco_errors();
  if (const auto own = registered().find(name); own != registered().end()) {
    if (scene.empty()) return own->second;
    throw std::invalid_argument(
        fmt::format("robot '{}' is registered from a file and stands in no scene; '{}' was asked "
                    "for",
                    name, scene));
  }
  const std::string_view robot = embedded(kEmbeddedRobots, "robot", name);
  const std::string file = fmt::format("{}.xml", name);
  std::string include = fmt::format("<include file=\"{}\"/>", file);
  if (!scene.empty()) include += "<include file=\"scene.xml\"/>";
  const std::string main = fmt::format("<mujoco>{}</mujoco>", include);
  std::vector<std::pair<std::string, std::string_view>> files{{"main.xml", main}, {file, robot}};
  if (!scene.empty()) files.emplace_back("scene.xml", embedded(kEmbeddedScenes, "scene", scene));
  try {
    return load_files(files);
  } catch (const std::runtime_error& e) {
    throw std::runtime_error(fmt::format("{} {}: {}", name, scene, e.what()));
  }
}

Model load_mjcf(const std::string& path, const ImportOptions& options, std::string* changes) {
  const RobotFile robot = robot_file(path, options);
  try {
    claim_input(robot.path);
    return load_files({{"robot.mjb", compiled_mjcf(robot.path, {}, robot.options, changes)}});
  } catch (const std::runtime_error& e) {
    if (robot.path == path) throw;
    throw std::runtime_error(fmt::format("{}: {}", path, e.what()));  // it may be what is wrong
  }
}

void register_mjcf(const std::string& name, const std::string& path) {
  const std::vector<std::string> taken = robot_names();
  if (name.empty() || std::count(taken.begin(), taken.end(), name) > 0) {
    throw std::invalid_argument(fmt::format("the name '{}' of a robot is taken, or empty", name));
  }
  registered().emplace(name, load_mjcf(path));
}

Model changed(const Model& model, const std::function<void(mjModel&)>& change) {
  mjModel* const m = mj_copyModel(nullptr, model.get());
  Model copy = owned(m);
  change(*m);
  const State d(mj_makeData(m));
  mj_setConst(m, d.get());
  return copy;
}

Model with_scaled_body(const Model& model, const std::string& body, double factor) {
  const int id = mj_name2id(model.get(), mjOBJ_BODY, body.c_str());
  if (id < 0) throw std::invalid_argument(fmt::format("the robot has no body '{}'", body));
  if (!(factor > 0) || !std::isfinite(factor)) {
    throw std::invalid_argument(
        fmt::format("body '{}': a mass factor must be positive, not {}", body, factor));
  }
  return changed(model, [&](mjModel& m) {
    m.body_mass[id] *= factor;
    for (int i = 0; i < 3; ++i) m.body_inertia[3 * id + i] *= factor;
  });
}

Model without_dry_friction(const Model& model) {
  return changed(model, [](mjModel& m) {
    std::fill_n(m.dof_frictionloss, m.nv, 0.);
    std::fill_n(m.tendon_frictionloss, m.ntendon, 0.);
  });
}

Model wallmobot3_with_panel(double panel) {
  constexpr double kLink5 = 177, kPanel = 150;  // [kg] Table II
  return with_scaled_body(load_robot("wallmobot3"), "link5", (kLink5 - kPanel + panel) / kLink5);
}

}  // namespace tauext
