// SPDX-License-Identifier: Apache-2.0
#include "bench/calibrate/robot_file_writer.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <stdexcept>
#include <system_error>

#include "bench/calibrate/arm_motion.h"
#include "mjcf/import/json_object.h"
#include "mjcf/import/robot_file.h"
#include "mjcf/plant/model.h"

namespace tauext {
namespace {

using Json = JsonObject::Json;
namespace fs = std::filesystem;

// to as many digits as an error has to be told by
double rounded(double x, int digits) {
  return std::stod(fmt::format("{:.{}g}", x, digits));
}

// friction is found as a whole: what was not asked for is 0
Json joint_json(const CalibratedJoint& j) {
  std::map<std::string, double> found;
  Json errors;
  bool friction = false;
  for (const CalibratedTerm& t : j.terms) {
    found[t.name] = t.value;
    errors[t.name] = rounded(t.error, 2);
    friction = friction || t.name != "armature";
  }
  Json json;
  if (found.count("armature") > 0) json["armature"] = rounded(found["armature"], 6);
  if (friction) {
    const double viscous = found["viscous"], skew = found["viscous_skew"];
    json["coulomb"] = rounded(found["coulomb"], 6);
    json["viscous"] = rounded(viscous, 6);
    if (skew != 0) json["viscous"] = {rounded(viscous + skew, 6), rounded(viscous - skew, 6)};
    json["offset"] = rounded(found["offset"], 6);
  }
  if (j.gain != 0) {
    const char* const key = j.of_currents ? "gain" : "torque_gain";
    json[key] = rounded(j.gain * j.gain_before, 6);
    errors[key] = rounded(std::abs(j.gain_error * j.gain_before), 2);
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

// with digits enough for a thin body to stay one
Json body_json(const MeasuredBody& b) {
  constexpr int kDigits = 12;
  Json json;
  json["mass"] = rounded(b.mass, kDigits);
  for (const double x : b.center) json["center"].push_back(rounded(x, kDigits));
  for (const double x : b.inertia) json["inertia"].push_back(rounded(x, kDigits));
  return json;
}

// a folder that is gone afterwards
class Folder {
 public:
  Folder() : path_((fs::temp_directory_path() / "tauext-calibrate-XXXXXX").string()) {
    if (!::mkdtemp(path_.data())) throw std::runtime_error(path_ + ": cannot make this folder");
  }
  ~Folder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  const std::string& path() const { return path_; }

 private:
  std::string path_;
};

// [N m] rms that is left of a joint's torque
double left_over(const std::vector<Trace>& logs, const std::vector<ArmMotion>& motions, int joint,
                 double gain, const Windows& w) {
  double squares = 0;
  int windows = 0, left_out = 0;
  for (std::size_t l = 0; l < logs.size(); ++l)
    for (const Window& window : windows_of(logs[l], joint, w, left_out)) {
      const double rest =
          gain * mean_torque(logs[l], joint, window) - motions[l].expected(joint, window);
      squares += rest * rest, ++windows;
    }
  return std::sqrt(squares / windows);
}

// what the file leaves, and what it might
void doubt_what_is_left(CalibratedJoint& j) {
  if (j.after <= 1.5 * j.unbounded + 0.02 * j.torque) return;
  std::string why = fmt::format(
      "the file would leave {:.3g} N m of its torque, and the fit without bounds leaves {:.3g} N m",
      j.after, j.unbounded);
  if (j.slip > j.fastest / 2)
    why += fmt::format(
        ": so little turns with it that its friction must be smooth over {:.3g} rad/s, to be "
        "simulated in steps of 1 ms, and it moves at most at {:.3g} rad/s. Write its rotor's "
        "inertia (armature, kg m^2) into the robot's file, and find the others "
        "(--terms coulomb,viscous,viscous_skew,offset)",
        j.slip, j.fastest);
  j.doubts.push_back(why);
}

// the last line of defence: no joint moves against more friction than its drive's torque
void doubt_friction(CalibratedJoint& j, double rated) {
  std::map<std::string, double> found;
  for (const CalibratedTerm& t : j.terms) found[t.name] = t.value;
  const double friction = std::max(found["coulomb"], found["viscous"] * j.fastest / 2);
  const double most = rated > 0 ? rated : j.largest;
  if (friction <= most) return;
  j.doubts.push_back(fmt::format(
      "its friction came out as {:.4g} N m (coulomb {:.4g} N m, viscous {:.4g} N m s/rad at {:.3g} "
      "rad/s), more than {}, {:.4g} N m: {}",
      friction, found["coulomb"], found["viscous"], j.fastest / 2,
      rated > 0 ? "the file's rated torque" : "the largest torque of the recordings", most,
      rated > 0 ? "correct its effort or force range, if that is wrong; else record motions at "
                  "several speeds, and see whether torques are in N m"
                : "record motions at several speeds, both ways"));
}

}  // namespace

ArmTree read_back(const NewRobotFile& robot) {
  const Folder folder;
  const std::string path = folder.path() + "/arm.json";
  std::ofstream(path) << robot_file_text(robot, path);
  return tree_of(load_mjcf(path));
}

void judge_by_file(NewRobotFile& robot, const std::vector<Trace>& logs, const Windows& windows) {
  const ArmTree arm = read_back(robot);
  std::vector<ArmMotion> motions;
  for (const Trace& log : logs) motions.emplace_back(arm, log);
  for (int i = 0; i < arm.dof(); ++i) {
    CalibratedJoint& j = robot.joints[static_cast<std::size_t>(i)];
    j.after = left_over(logs, motions, i, j.gain == 0 ? 1 : j.gain, windows);
    doubt_what_is_left(j);
    doubt_friction(j, arm.rated_torque[i]);
  }
}

std::string robot_file_text(const NewRobotFile& robot, const std::string& out) {
  const RobotFile source = robot_file(robot.from, {robot.lock, {}});
  Json json;
  if (is_our_robot_file(robot.from)) json = read_json(robot.from);
  json["format"] = kRobotFileFormat;
  const fs::path folder = out == "-" ? fs::current_path() : fs::absolute(out).parent_path();
  json["file"] = fs::proximate(fs::absolute(source.path), folder).string();
  if (!source.options.lock.empty()) json["lock"] = source.options.lock;
  for (const CalibratedJoint& j : robot.joints) {
    Json& known = json["joints"][j.name];
    const Json found = joint_json(j);
    for (const auto& [key, value] : found.items()) known[key] = value;
  }
  for (const auto& [name, body] : robot.bodies) json["bodies"][name] = body_json(body);
  if (robot.payload != nullptr) json["payload"] = payload_json(*robot.payload);
  json["about"] = {{"made_by", "tauext-calibrate"}, {"recordings", robot.recordings}};
  return json.dump(2) + "\n";
}

}  // namespace tauext
