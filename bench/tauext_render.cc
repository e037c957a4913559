// SPDX-License-Identifier: Apache-2.0
// tauext-render: a picture of a robot.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <stdexcept>
#include <string>
#include <vector>

#include "bench/program/program.h"
#include "bench/roster/robots.h"
#include "mjcf/picture/picture.h"

namespace {

using namespace tauext;

struct Flags {
  std::string robot, lock, out, size = "1200x900";
  std::vector<double> q;
  View view;
  bool list = false;
};

void add_flags(CLI::App& app, Flags& f) {
  add_robot_flags(app, f.robot, f.lock);
  app.add_option("--q", f.q, "pose, a number for each joint [rad, m]; else 0, of a file its home")
      ->delimiter(',')
      ->type_name("Q1,Q2..");
  app.add_option("--camera", f.view.camera, "camera of the robot (see --list), like side");
  app.add_option("--azimuth", f.view.azimuth, "without a camera: look from x to y [degrees]")
      ->capture_default_str();
  app.add_option("--elevation", f.view.elevation, "and up [degrees]")->capture_default_str();
  app.add_option("--size", f.size, "[pixels]")->type_name("WxH")->capture_default_str();
  app.add_option("--out", f.out, "PNG to write; - is standard output");
  app.add_flag("--list", f.list, "list robots, or one's cameras and number of joints, and stop");
}

int list(const Flags& f) {
  if (f.robot.empty()) {
    fmt::print("{}\n", fmt::join(robot_names(), "\n"));
    return kGood;
  }
  const Robot& r = robot(f.robot, f.lock);
  const std::vector<std::string> cameras = cameras_of(r.model());
  fmt::print("cameras: {}\n{} joints\n",
             cameras.empty() ? "none" : fmt::format("{}", fmt::join(cameras, ", ")), r.dof());
  return kGood;
}

int render(Flags& f) {
  if (f.list) return list(f);
  if (f.robot.empty() || f.out.empty())
    throw std::invalid_argument("--robot and --out are required; see tauext-render --help");
  int end = 0;
  if (std::sscanf(f.size.c_str(), "%dx%d%n", &f.view.width, &f.view.height, &end) != 2 ||
      f.size.c_str()[end] != '\0') {
    throw std::invalid_argument(fmt::format("--size {}: width x height, like 1200x900", f.size));
  }
  const Robot& r = robot(f.robot, f.lock);
  Eigen::VectorXd q = Eigen::VectorXd::Zero(r.dof());
  if (r.is_from_file()) q = r.home();
  if (!f.q.empty()) q = Eigen::VectorXd::Map(f.q.data(), static_cast<Eigen::Index>(f.q.size()));
  write_picture(r.model(), q, f.view, f.out);
  return kGood;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "Draws a robot in a pose and writes a PNG.\n\n"
      "  tauext-render --robot wallmobot3 --camera front --out wallmobot3.png\n",
      "tauext-render");
  Flags flags;
  add_flags(app, flags);
  return run_program(app, argc, argv, [&] { return render(flags); });
}
