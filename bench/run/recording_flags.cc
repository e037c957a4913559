// SPDX-License-Identifier: Apache-2.0
#include "bench/run/recording_flags.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "bench/program/program.h"
#include "bench/score/degradation.h"

namespace tauext {

const std::vector<const char*>& recording_flags() {
  static const std::vector<const char*> all = {"--degrade",
                                               "--sensors",
                                               "--loadcell",
                                               "--model_error",
                                               "--drives",
                                               "--velocity_noise",
                                               "--encoder_step",
                                               "--loadcell_noise",
                                               "--seed",
                                               "--kp",
                                               "--kd"};
  return all;
}

void add_recording_flags(CLI::App& app, Sensors& s, ModelError& e, Recording& r) {
  const auto list = [&](const char* name, auto& fields, const char* help) {
    app.add_option_function<std::vector<std::string>>(
           name,
           [&fields](const std::vector<std::string>& items) {
             try {
               set_fields(items, fields);
             } catch (const std::invalid_argument& error) {
               throw CLI::ValidationError(fmt::format("--{}", error.what()));
             }
           },
           help)
        ->delimiter(',')
        ->allow_extra_args(false)
        ->type_name("K=V,..");
  };
  // first, so that flags have the last word
  app.add_option_function<std::string>(
         "--degrade",
         [&](const std::string& path) {
           Degradation d{s, e, r.drives};
           read_degradation(path, d);
           s = d.sensors, e = d.model_error, r.drives = d.drives;
         },
         "faults of sensors and drives: light, typical, hard or a JSON file")
      ->type_name("NAME|FILE");
  list("--sensors", s, "their faults: velocity_noise=1e-3,latency=0.002,dropped=0.01,..");
  list("--loadcell", s.loadcell, "faults of the loadcells, like noise=1,offset=5 [N]");
  list("--model_error", e, "what estimators do not know: mass=1.05,..; --drives: stiffness=200,..");
  list("--drives", r.drives, "elastic joints and what rubs in them: stiffness=300,coulomb=0.01,..");
  app.get_option("--drives")->group("");  // the help fits a screen: bench/score/README.md
  app.add_option("--velocity_noise", s.velocity_noise, "the same as in --sensors [rad/s]")
      ->capture_default_str();
  app.add_option("--encoder_step", s.encoder_step)->group("");  // likewise
  app.add_option("--loadcell_noise", s.loadcell_noise)->group("");
  app.add_option("--seed", s.seed, "of the sensors' faults")
      ->check(whole_number, "WHOLE")
      ->capture_default_str();
  app.add_option("--kp", r.Kp,
                 "tracking stiffness [1/s^2] and --kd damping [1/s], else the scenario's");
  app.add_option("--kd", r.Kd)->group("");
}

}  // namespace tauext
