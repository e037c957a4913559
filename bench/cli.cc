// SPDX-License-Identifier: Apache-2.0
#include "bench/cli.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cstdio>
#include <stdexcept>

#include "bench/robot.h"

namespace tauext {

void add_recording_flags(CLI::App& app, Sensors& s, Recording& r) {
  app.add_option("--velocity_noise", s.velocity_noise, "standard deviation [rad/s]")
      ->capture_default_str();
  app.add_option("--encoder_step", s.encoder_step, "quantisation of q [rad]")
      ->capture_default_str();
  app.add_option("--loadcell_noise", s.loadcell_noise, "standard deviation [N m]")
      ->capture_default_str();
  app.add_option("--seed", s.seed, "of the sensors' noise")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  app.add_option("--kp", r.tracking.Kp, "tracking stiffness [1/s^2]")->capture_default_str();
  app.add_option("--kd", r.tracking.Kd, "tracking damping [1/s]")->capture_default_str();
}

int run_program(CLI::App& app, int argc, char** argv, const std::function<int()>& body) {
  app.set_version_flag("--version", fmt::format("{} {}", app.get_name(), TAUEXT_VERSION));
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& e) {
    return app.exit(e);
  } catch (const CLI::ParseError& e) {
    fmt::print(stderr, "{0}: {1}\n{0}: see {0} --help\n", app.get_name(), e.what());
    return kCouldNotRun;
  }
  try {
    const int code = body();
    if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0) {
      throw std::runtime_error("cannot write to standard output");
    }
    return code;
  } catch (const std::exception& e) {
    fmt::print(stderr, "{}: {}\n", app.get_name(), e.what());
    return kCouldNotRun;
  }
}

std::string list_known() {
  std::string out;
  for (const Robot& r : robots()) {
    out += fmt::format("robot {}, {} joints\n  estimators  {}\n  detectors   {}\n", r.name, r.dof,
                       fmt::join(r.estimators, ", "), fmt::join(r.detectors, ", "));
  }
  out += "scenarios\n";
  for (const Scenario& s : scenarios()) out += fmt::format("  {:<11} {}\n", s.name, s.description);
  return out;
}

}  // namespace tauext
