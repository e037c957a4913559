// SPDX-License-Identifier: Apache-2.0
#include "mjcf/import/robot_file.h"

#include <fmt/format.h>

#include <filesystem>
#include <stdexcept>
#include <utility>

#include "mjcf/import/json_object.h"
#include "mjcf/trace/printable.h"

namespace tauext {
namespace {

using Json = JsonObject::Json;

constexpr double kMuch = 1e6;     // [kg, N m, ..]
constexpr double kLittle = 1e-6;  // [N m, rad/s] no drive does less

// a number, or one for each direction: their mean, and half of their difference
std::optional<std::pair<double, double>> both_ways(const JsonObject& o, const char* key) {
  if (!o.has(key)) return {};
  if (!o.at(key).is_array()) return std::pair(o.number(key, 0, kMuch), 0.);
  const Eigen::VectorXd v = o.vector(key, 2);
  if (v.minCoeff() >= 0) return std::pair(v.mean(), (v[0] - v[1]) / 2);
  throw std::invalid_argument(
      fmt::format("{}: \"{}\" is [{:g}, {:g}], and must be 0 or more", o.where(), key, v[0], v[1]));
}

std::optional<double> number(const JsonObject& o, const char* key, double least) {
  if (!o.has(key)) return {};
  return o.number(key, least, kMuch);
}

MeasuredJoint joint_of(const Json& json, const std::string& where) {
  const JsonObject o(json, where,
                     {"armature", "coulomb", "viscous", "offset", "gain", "torque_gain", "effort",
                      "velocity", "standard_errors", "about"});
  MeasuredJoint j;
  j.armature = number(o, "armature", 0);
  j.offset = number(o, "offset", -kMuch);
  if (const auto coulomb = both_ways(o, "coulomb")) {
    j.coulomb = coulomb->first;
    if (coulomb->second != 0) j.offset = j.offset.value_or(0) + coulomb->second;
  }
  if (const auto viscous = both_ways(o, "viscous")) {
    j.viscous = viscous->first;
    j.viscous_skew = viscous->second;
  }
  j.gain = number(o, "gain", -kMuch);
  if (j.gain && *j.gain == 0)
    throw std::invalid_argument(where + ": \"gain\" is 0: a current would do nothing");
  j.torque_gain = number(o, "torque_gain", kLittle);
  j.effort = number(o, "effort", kLittle);
  j.velocity = number(o, "velocity", kLittle);
  return j;
}

Payload payload_of(const Json& json, const std::string& where) {
  const JsonObject o(json, where, {"body", "mass", "center", "standard_errors"});
  Payload p;
  p.body = o.text("body", "");
  if (p.body.empty()) throw std::invalid_argument(where + ": \"body\" must name one");
  p.mass = o.number("mass", 0, kMuch);
  const Eigen::VectorXd c = o.vector("center", 3);
  for (int i = 0; i < 3; ++i) p.center[i] = c[i];
  return p;
}

RobotFile robot_of(const Json& json, const std::string& path) {
  const JsonObject o(json, path, {"format", "file", "lock", "joints", "payload", "about"});
  if (o.text("format", "") != kRobotFileFormat)
    throw std::invalid_argument(fmt::format(
        "{}: no robot file: its \"format\" is {}, and must be \"{}\"", path,
        o.has("format") ? printable_name(o.at("format").dump()) : "missing", kRobotFileFormat));
  RobotFile r;
  const std::string file = o.text("file", "");
  if (file.empty() || is_our_robot_file(file))
    throw std::invalid_argument(path + ": \"file\" must name an MJCF or URDF file");
  r.path = (std::filesystem::path(path).parent_path() / file).string();
  r.options.lock = o.text("lock", "");
  if (o.has("joints")) {
    if (!o.at("joints").is_object())
      throw std::invalid_argument(path + ": \"joints\" must be an object, a key for each joint");
    for (const auto& [name, joint] : o.at("joints").items())
      r.options.measured.joints.emplace(
          name, joint_of(joint, fmt::format("{}: joint '{}'", path, printable_name(name))));
  }
  if (o.has("payload"))
    r.options.measured.payload = payload_of(o.at("payload"), path + ": payload");
  return r;
}

}  // namespace

bool is_our_robot_file(std::string_view path) {
  return path.ends_with(".json");
}

RobotFile robot_file(const std::string& path, const ImportOptions& options) {
  if (!is_our_robot_file(path)) return {path, options};
  RobotFile robot = robot_of(read_json(path), path);
  std::string& lock = robot.options.lock;
  if (!options.lock.empty() && !lock.empty())
    throw std::invalid_argument(
        fmt::format("{}: has a \"lock\" of its own, so --lock cannot be another one", path));
  if (lock.empty()) lock = options.lock;
  robot.options.balance = options.balance;
  return robot;
}

}  // namespace tauext
