// SPDX-License-Identifier: Apache-2.0
#include "mjcf/import/robot_file.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <system_error>
#include <utility>
#include <vector>

#include "mjcf/import/json_object.h"
#include "mjcf/import/masses/body_masses.h"
#include "mjcf/import/masses/inertia.h"
#include "mjcf/import/mendable.h"
#include "mjcf/trace/printable.h"
#include "mjcf/trace/text.h"

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

MeasuredBody body_of(const Json& json, const std::string& where) {
  const JsonObject o(json, where, {"mass", "center", "inertia", "about"});
  MeasuredBody b;
  b.mass = o.number("mass", kLittle, kMuch);
  const Eigen::VectorXd c = o.vector("center", 3), I = o.vector("inertia", 6);
  std::copy(c.begin(), c.end(), b.center);
  std::copy(I.begin(), I.end(), b.inertia);
  const Eigen::Vector3d m = detail::mended(detail::tensor(b), b.mass).moments;
  const double missing = std::max(-m[0], m[2] - m[0] - m[1]);
  if (m[0] > 0 && missing <= 1e-6 * m[2]) return b;  // as many digits as people print
  throw std::invalid_argument(fmt::format(
      "{}: \"inertia\" has the principal moments {:.4g}, {:.4g} and {:.4g} kg m^2, and no body has "
      "those: each must be above 0, and at most the sum of the others. It is [xx, yy, zz, xy, xz, "
      "yz] about the center of mass",
      where, m[0], m[1], m[2]));
}

// an object with a key for each
template <class Take>
void each_of(const JsonObject& o, const std::string& path, const char* key, const char* kind,
             Take&& take) {
  if (!o.has(key)) return;
  if (!o.at(key).is_object())
    throw std::invalid_argument(
        fmt::format("{}: \"{}\" must be an object, a key for each {}", path, key, kind));
  for (const auto& [name, value] : o.at(key).items())
    take(name, value, fmt::format("{}: {} '{}'", path, kind, printable_name(name)));
}

RobotFile robot_of(const Json& json, const std::string& path) {
  const JsonObject o(json, path,
                     {"format", "file", "lock", "joints", "bodies", "payload", "about"});
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
  MeasuredTerms& measured = r.options.measured;
  each_of(o, path, "joints", "joint",
          [&](const std::string& name, const Json& j, const std::string& where) {
            measured.joints.emplace(name, joint_of(j, where));
          });
  each_of(o, path, "bodies", "body",
          [&](const std::string& name, const Json& b, const std::string& where) {
            measured.bodies.emplace(name, body_of(b, where));
          });
  if (o.has("payload")) measured.payload = payload_of(o.at("payload"), path + ": payload");
  return r;
}

namespace fs = std::filesystem;

// package://NAME/PATH is ROS's, for what lies in NAME's folder of shared files
std::string why_address(const std::string& path) {
  const std::size_t at = path.find("://") + 3;
  const std::string scheme = path.substr(0, at), rest = path.substr(at);
  if (scheme == "file://") return fmt::format("{}: give its path, {}", path, rest);
  if (scheme != "package://")
    return fmt::format("{}: a file is wanted, not an address: download it first", path);
  const std::size_t end = std::min(rest.find('/'), rest.size());
  return fmt::format(
      "{}: an address of ROS is not looked up here; its file is $(ros2 pkg prefix --share {}){}",
      path, rest.substr(0, end), rest.substr(end));
}

// whether it is one, by how it begins
bool is_robot(const fs::path& file) {
  const std::string kind = in_small_letters(file.extension().string());
  if (kind == ".urdf" || kind == ".xacro" || kind == ".mjcf") return true;
  if (kind != ".xml") return false;
  std::string begin(4096, ' ');
  std::ifstream(file).read(begin.data(), static_cast<std::streamsize>(begin.size()));
  return begin.find("<mujoco") != begin.npos || begin.find("<robot") != begin.npos;
}

std::string why_folder(const std::string& path) {
  std::vector<std::string> robots;
  std::error_code error;
  int looked_at = 0;  // a folder may be the whole disk
  for (fs::recursive_directory_iterator at(path, error), end;
       !error && at != end && ++looked_at < 2000; at.increment(error)) {
    if (at.depth() > 2) at.disable_recursion_pending();
    if (at->is_regular_file(error) && is_robot(at->path())) robots.push_back(at->path().string());
  }
  std::sort(robots.begin(), robots.end());
  const std::size_t found = robots.size();
  if (found > 8) robots.resize(8);
  return fmt::format("{}: it is a folder; {}{}", path,
                     found == 0
                         ? "name an MJCF or URDF file"
                         : fmt::format("name a robot's file, like {}", fmt::join(robots, ", ")),
                     found > robots.size() ? ", .." : "");
}

}  // namespace

std::string why_other_kind(const std::string& path) {
  if (path.find("://") != path.npos) return why_address(path);
  std::error_code error;
  if (fs::is_directory(path, error)) return why_folder(path);
  const fs::path file = path;
  const std::string plain = shell_word(fs::path(file).replace_extension().string());
  const std::string kind = in_small_letters(file.extension().string()), own = shell_word(path);
  if (kind == ".xacro") {
    const bool named = fs::path(file.stem()).extension() == ".urdf";  // arm.urdf.xacro
    return fmt::format(
        "{}: xacro has to be run first: xacro {} > {} (the package xacro of ROS, or pip's)", path,
        own, named ? plain : plain + ".urdf");
  }
  if (kind == ".sdf" || kind == ".world")
    return fmt::format(
        "{0}: SDF is not read here; this makes MJCF of it: sdf2mjcf {1} {2}.xml (pip install "
        "sdformat-mjcf)",
        path, own, plain);
  if (kind == ".usd" || kind == ".usda" || kind == ".usdc" || kind == ".usdz")
    return fmt::format(
        "{}: USD is not read here; this makes URDF of it: usd_to_urdf -o {}.urdf {} (pip install "
        "nvidia-srl-usd-to-urdf)",
        path, plain, own);
  if (kind == ".mjb")
    return path + ": MuJoCo's binary form is not read here; give the MJCF that it was made of";
  return "";
}

bool is_our_robot_file(std::string_view path) {
  return path.ends_with(".json");
}

RobotFile robot_file(const std::string& path, const ImportOptions& options) {
  if (const std::string why = why_other_kind(path); !why.empty()) throw std::invalid_argument(why);
  if (!is_our_robot_file(path)) return {path, options};
  RobotFile robot = robot_of(read_json(path), path);
  std::string& lock = robot.options.lock;
  if (!options.lock.empty() && !lock.empty())
    throw std::invalid_argument(
        fmt::format("{}: has a \"lock\" of its own, so --lock cannot be another one", path));
  if (lock.empty()) lock = options.lock;
  robot.options.balance = options.balance;
  robot.options.masses_unknown = options.masses_unknown;
  return robot;
}

}  // namespace tauext
