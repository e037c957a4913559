// SPDX-License-Identifier: Apache-2.0
#include "bench/calibrate/robot_file_writer.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <map>

#include "mjcf/import/json_object.h"
#include "mjcf/import/robot_file.h"
#include "mjcf/trace/printable.h"

namespace tauext {
namespace {

using Json = JsonObject::Json;
namespace fs = std::filesystem;

// to as many digits as an error has to be told by
double rounded(double x, int digits) {
  return std::stod(fmt::format("{:.{}g}", x, digits));
}

// friction is found as a whole: what was not asked for is 0
Json joint_json(const CalibratedJoint& j, std::vector<std::string>& said) {
  std::map<std::string, double> found;
  Json errors;
  bool friction = false;
  for (const CalibratedTerm& t : j.terms) {
    const bool any_sign = t.name == "offset" || t.name == "viscous_skew";
    if (t.value < 0 && !any_sign)
      said.push_back(fmt::format("{}: {} came out as {:.3g} +- {:.2g}, and is written as 0",
                                 printable_name(j.name), t.name, t.value, t.error));
    found[t.name] = any_sign ? t.value : std::max(t.value, 0.);
    errors[t.name] = rounded(t.error, 2);
    friction = friction || t.name != "armature";
  }
  Json json;
  if (found.count("armature") > 0) json["armature"] = rounded(found["armature"], 6);
  if (friction) {
    const double viscous = found["viscous"],
                 skew = std::clamp(found["viscous_skew"], -viscous, viscous);
    json["coulomb"] = rounded(found["coulomb"], 6);
    json["viscous"] = rounded(viscous, 6);
    if (skew != 0) json["viscous"] = {rounded(viscous + skew, 6), rounded(viscous - skew, 6)};
    json["offset"] = rounded(found["offset"], 6);
  }
  if (j.gain != 0) {
    json["gain"] = rounded(j.gain, 6);
    errors["gain"] = rounded(j.gain_error, 2);
  }
  json["standard_errors"] = errors;
  return json;
}

Json payload_json(const Weighing& w) {
  const auto list = [](const Eigen::Vector3d& v, int digits) {
    return Json{rounded(v[0], digits), rounded(v[1], digits), rounded(v[2], digits)};
  };
  return {{"body", w.body},
          {"mass", rounded(w.payload.mass, 6)},
          {"center", list(w.center, 6)},
          {"standard_errors",
           {{"mass", rounded(w.payload.mass_error, 2)}, {"center", list(w.center_error, 2)}}}};
}

}  // namespace

std::string robot_file_text(const NewRobotFile& robot, const std::string& out,
                            std::vector<std::string>& said) {
  const RobotFile source = robot_file(robot.from, {robot.lock, {}});
  Json json;
  if (is_our_robot_file(robot.from)) json = read_json(robot.from);
  json["format"] = kRobotFileFormat;
  const fs::path folder = out == "-" ? fs::current_path() : fs::absolute(out).parent_path();
  json["file"] = fs::proximate(fs::absolute(source.path), folder).string();
  if (!source.options.lock.empty()) json["lock"] = source.options.lock;
  for (const CalibratedJoint& j : robot.joints) {
    Json& known = json["joints"][j.name];
    const Json found = joint_json(j, said);
    for (const auto& [key, value] : found.items()) known[key] = value;
  }
  if (robot.payload != nullptr) json["payload"] = payload_json(*robot.payload);
  json["about"] = {{"made_by", "tauext-calibrate"}, {"recordings", robot.recordings}};
  return json.dump(2) + "\n";
}

}  // namespace tauext
