// SPDX-License-Identifier: Apache-2.0
#include "bench/run/study_flags.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <stdexcept>
#include <vector>

#include "bench/program/program.h"
#include "bench/roster/robots.h"
#include "bench/study/equal_bandwidth.h"
#include "bench/study/pareto.h"
#include "bench/study/reliability.h"
#include "mjcf/trace/atomic_file.h"

namespace tauext {
namespace {

TableFormat format_of(const StudyFlags& f) {
  return table_format(f.format.value_or("text"));
}

const Robot& robot_of(const StudyFlags& f) {
  return f.robot ? robot(*f.robot) : *robots().front();
}

// at the noise that was asked for, or at a good and at a poor encoder's
std::string run_reliability(const StudyFlags& f, const Sensors& sensors) {
  std::vector<study::Tried> all(sensors.ideal() ? 2 : 1);
  for (study::Tried& tried : all) {
    tried.trials.robot = f.robot.value_or("");
    tried.trials.sensors = sensors;
  }
  if (sensors.ideal()) {
    all[0].trials.sensors.velocity_noise = 1e-4;
    all[1].trials.sensors.velocity_noise = 1e-3;
  }
  for (study::Tried& tried : all) {
    Progress progress("trying");
    tried.rows = study::reliability(tried.trials, progress.callback());
  }
  return study::format_reliability(all, format_of(f));
}

std::string run_equal_bandwidth(const StudyFlags& f) {
  Progress progress("tuning");
  const double w = *f.equal_bandwidth;
  const auto rows = study::at_equal_bandwidth(robot_of(f), w, 0, progress.callback());
  return study::format_equal_bandwidth(robot_of(f), w, rows, format_of(f));
}

std::string run_pareto(const StudyFlags& f) {
  Progress progress("sweeping");
  const auto points = study::pareto(robot_of(f), 0, progress.callback());
  return study::format_pareto(robot_of(f), points, format_of(f));
}

}  // namespace

void add_study_flags(CLI::App& app, StudyFlags& f) {
  app.add_flag("--reliability", f.reliability,
               "study instead: 200 blows and an hour of a human's hand");
  app.add_option("--equal-bandwidth", f.equal_bandwidth,
                 "study instead: every estimator at so many rad/s, 1 to 200")
      ->type_name("W");
  app.add_flag("--pareto", f.pareto, "study instead: noise against delay (all three: --out)");
  app.add_option("--format", f.format, "of the tables: text, csv, json, md or latex")
      ->type_name("NAME");
  app.add_option("--out", f.out)->group("");  // the help fits a screen: bench/study/README.md
}

bool wants_study(const StudyFlags& f) {
  if (f.studies() == 0 && f.out) {
    throw std::invalid_argument("--out goes with --reliability, --equal-bandwidth or --pareto");
  }
  if (format_of(f) != TableFormat::kText && f.studies() > 1) {
    throw std::invalid_argument(
        fmt::format("--format {} holds one study: ask for one at a time", *f.format));
  }
  return f.studies() > 0;
}

int run_study(const StudyFlags& f, const SuiteOptions& suite) {
  if (!suite.model_error.none()) {
    throw std::invalid_argument("a study brings its own model errors, or none: no --model_error");
  }
  const bool seed = suite.sensors.seed != Sensors().seed;
  if ((seed || !suite.sensors.ideal()) && (f.equal_bandwidth || f.pareto)) {
    throw std::invalid_argument(
        "--equal-bandwidth and --pareto bring their own sensors: they take no faults and no "
        "--seed");
  }
  if (!suite.thresholds.sets.empty() || suite.recording.Kp || suite.recording.Kd) {
    throw std::invalid_argument("a study takes no --thresholds, --kp and --kd");
  }
  AtomicFile file(f.out.value_or("-"));  // an unwritable path should not cost a run
  if (f.reliability) file.write(run_reliability(f, suite.sensors));
  if (f.equal_bandwidth) file.write(run_equal_bandwidth(f));
  if (f.pareto) file.write(run_pareto(f));
  file.commit();
  return kGood;
}

}  // namespace tauext
