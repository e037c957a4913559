// SPDX-License-Identifier: Apache-2.0
#include "bench/calibrate/robot_file_writer.h"

#include <fmt/format.h>

#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "mjcf/import/robot_file.h"
#include "mjcf/trace/input_file.h"
#include "mjcf/trace/printable.h"

namespace tauext {
namespace {

using Json = nlohmann::ordered_json;
namespace fs = std::filesystem;

// to as many digits as an error has to be told by
double rounded(double x, int digits) {
  return std::stod(fmt::format("{:.{}g}", x, digits));
}

Json joint_json(const CalibratedJoint& j, std::vector<std::string>& said) {
  Json json, errors;
  double viscous = 0, skew = 0;
  for (const CalibratedTerm& t : j.terms) {
    double value = t.value;
    if (value < 0 && t.name != "offset" && t.name != "viscous_skew") {
      said.push_back(fmt::format("{}: {} came out as {:.3g} +- {:.2g}, and is written as 0",
                                 printable_name(j.name), t.name, value, t.error));
      value = 0;
    }
    if (t.name == "viscous") viscous = value;
    if (t.name == "viscous_skew") {
      skew = std::clamp(value, -viscous, viscous);
    } else {
      json[t.name] = rounded(value, 6);
    }
    errors[t.name] = rounded(t.error, 2);
  }
  if (skew != 0) json["viscous"] = {rounded(viscous + skew, 6), rounded(viscous - skew, 6)};
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
  if (is_our_robot_file(robot.from)) json = Json::parse(read_json_text(robot.from));
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
