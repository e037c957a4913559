// SPDX-License-Identifier: Apache-2.0
#include "bench/cli.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <stdexcept>

#include "bench/degradation.h"
#include "bench/lcm_trace.h"
#include "bench/robot.h"

namespace tauext {

namespace {

// CLI11 takes a number that does not fit for the largest that does
std::string whole_number(const std::string& text) {
  std::uint64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error == std::errc() && end == text.data() + text.size()) return "";
  return fmt::format("{} is not a whole number from 0 to {}", text,
                     std::numeric_limits<std::uint64_t>::max());
}

}  // namespace

void add_recording_flags(CLI::App& app, Sensors& s, ModelError& e, Recording& r) {
  const auto list = [&](const char* name, auto& fields, const char* help) {
    app.add_option_function<std::vector<std::string>>(
           name,
           [&fields, name](const std::vector<std::string>& items) {
             try {
               set_fields(items, fields);
             } catch (const std::invalid_argument& error) {
               throw CLI::ValidationError(name, error.what());
             }
           },
           help)
        ->delimiter(',')
        ->allow_extra_args(false)
        ->type_name("KEY=VALUE,..");
  };
  // first, so that flags have the last word
  app.add_option_function<std::string>(
         "--degrade",
         [&s, &e](const std::string& path) {
           Degradation d{s, e};
           read_degradation(path, d);
           s = d.sensors, e = d.model_error;
         },
         "sensor faults and model errors of a JSON file")
      ->type_name("FILE");
  list("--sensors", s, "their faults: velocity_noise=1e-3,latency=0.002,dropped=0.01,..");
  list("--loadcell", s.loadcell, "faults of the loadcells, like noise=1,offset=5 [N]");
  list("--model_error", e, "what estimators do not know: mass=1.05,com=0.01,friction=2,..");
  app.add_option("--velocity_noise", s.velocity_noise, "the same as in --sensors [rad/s]")
      ->capture_default_str();
  app.add_option("--encoder_step", s.encoder_step)->group("");  // likewise
  app.add_option("--loadcell_noise", s.loadcell_noise)->group("");
  app.add_option("--seed", s.seed, "of the sensors' faults")
      ->check(whole_number, "WHOLE")
      ->capture_default_str();
  app.add_option("--kp", r.Kp, "tracking stiffness [1/s^2], else the scenario's own");
  app.add_option("--kd", r.Kd, "tracking damping [1/s], else the scenario's own");
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
  } catch (const std::exception& e) {  // of a flag that reads a file
    fmt::print(stderr, "{}: {}\n", app.get_name(), e.what());
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

void report_skipped(const SkippedRows& s, const std::string& log) {
  if (s.total() == 0) return;
  fmt::print(
      stderr,
      "{}: skipped {} rows: {} with a wrong number of fields, {} not a number, {} not finite, "
      "{} out of time order\n",
      log, s.total(), s.wrong_field_count, s.not_a_number, s.not_finite, s.time_order);
  for (const std::string& line : s.first) fmt::print(stderr, "  {}\n", line);
  if (s.total() > static_cast<int>(s.first.size())) fmt::print(stderr, "  ...\n");
}

Trace read_log_or_csv(const std::string& path, const std::string& channel) {
  if (!is_lcm_log(path)) {
    SkippedRows skipped;
    Trace trace = read_csv(path, &skipped);
    report_skipped(skipped, path);
    return trace;
  }
  LogReport report;
  Trace trace = read_lcm(path, channel, &report);
  if (const std::string faults = report.in_words(); !faults.empty()) {
    fmt::print(stderr, "{}: channel {}: {}\n", path, report.channel, faults);
  }
  return trace;
}

void refuse_same_file(const std::string& log, const std::string& out) {
  std::error_code ignored;  // a file that is not there yet is no other file
  if (std::filesystem::equivalent(log, out, ignored)) {
    throw std::invalid_argument(fmt::format("--out {} is the log itself", out));
  }
}

std::string list_known() {
  std::string out;
  for (const Robot& r : robots()) {
    out += fmt::format("robot {}, {} joints\n  estimators  {}\n  detectors   {}\n", r.name, r.dof,
                       fmt::join(r.estimators, ", "), fmt::join(r.detectors, ", "));
    out += "  scenarios\n";
    for (const Scenario& s : scenarios(r.name))
      out += fmt::format("    {:<12} {}\n", s.name, s.description);
  }
  return out;
}

}  // namespace tauext
