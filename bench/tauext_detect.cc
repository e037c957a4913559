// SPDX-License-Identifier: Apache-2.0
// tauext-detect: calibrates the detectors, and studies every one behind every estimator.
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <string>
#include <vector>

#include "bench/cli.h"
#include "bench/detection_report.h"
#include "bench/detection_study.h"
#include "mjcf/atomic_file.h"

namespace {

using namespace tauext;

struct Flags {
  StudyOptions study;
  CalibrationOptions calibration;
  std::string calibrate_to, thresholds, out;
  bool list = false;
};

// a bar on a terminal, with the time that is left
class Progress {
 public:
  explicit Progress(const char* what) : what_(what), show_(::isatty(STDERR_FILENO) == 1) {}
  ~Progress() {
    if (show_) fmt::print(stderr, "\r\033[K");
  }
  std::function<void(double)> operator()() {
    if (!show_) return nullptr;
    return [this](double share) {
      const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - start_;
      fmt::print(stderr, "\r\033[K{} [{:<40}] {:.0f} %, {:.0f} s left", what_,
                 std::string(static_cast<std::size_t>(40 * share), '='), 100 * share,
                 spent.count() * (1 - share) / share);
    };
  }

 private:
  const char* what_;
  bool show_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

Thresholds calibrated(const Flags& f) {
  Progress progress("calibrating");
  CalibrationOptions o = f.calibration;
  o.estimators = f.study.estimators;
  o.threads = f.study.threads;
  o.progress = progress();
  return calibrate(o);
}

// an unwritable path should not cost a run
void require_writable(const std::string& path) {
  const AtomicFile probe(path);
}

int run(Flags& f) {
  if (f.list) {
    const std::vector<std::string>& trained = training_conditions();
    for (const Condition& c : conditions()) {
      const bool is_trained = std::count(trained.begin(), trained.end(), c.name) > 0;
      fmt::print("{:<18} {}{}\n", c.name, c.description, is_trained ? " (trained on)" : "");
    }
    return kGood;
  }
  if (!f.calibrate_to.empty()) {
    require_writable(f.calibrate_to);
    write_thresholds(calibrated(f), f.calibrate_to);
    if (f.calibrate_to != "-") fmt::print(stderr, "{}: thresholds\n", f.calibrate_to);
    return kGood;
  }
  if (!f.out.empty()) require_writable(f.out);
  check_study(f.study);  // before calibration takes its time
  const Thresholds thresholds =
      f.thresholds.empty() ? calibrated(f) : read_thresholds(f.thresholds);
  std::vector<Cell> cells;
  {
    Progress progress("studying");
    f.study.progress = progress();
    cells = detection_study(f.study, thresholds);
  }
  fmt::print("thresholds: {}, margin {:g}; test seeds from {} on\n\n{}", thresholds.trained_on,
             thresholds.margin, f.study.first_seed, format_study(cells));
  if (!f.out.empty()) {
    AtomicFile file(f.out);
    file.write(study_json(cells, thresholds));
    file.commit();
    fmt::print("\n{}: all of it as JSON, with points of the ROC\n", f.out);
  }
  return kGood;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "Every detector behind every estimator of wallmobot3: recall, delay, false alarms, pushes "
      "and\n"
      "clampings, under conditions from a known panel to an unknown one. Without a file of "
      "thresholds\n"
      "it calibrates first.\n\n"
      "  tauext-detect --calibrate thresholds.json\n"
      "  tauext-detect --thresholds thresholds.json --conditions known_150,unknown_150\n",
      "tauext-detect");
  app.get_formatter()->column_width(34);
  Flags f;
  const auto names = [&](const char* flag, std::vector<std::string>& to, const char* help) {
    app.add_option(flag, to, help)->delimiter(',')->allow_extra_args(false)->type_name("NAME,..");
  };
  app.add_option("--calibrate", f.calibrate_to,
                 "set the thresholds from training runs, write, stop")
      ->type_name("FILE");
  app.add_option("--margin", f.calibration.margin, "threshold over the largest value in training")
      ->capture_default_str();
  app.add_option("--thresholds", f.thresholds, "file of --calibrate")->type_name("FILE");
  app.add_option("--out", f.out, "write all of it as JSON, with points of the ROC")
      ->type_name("FILE");
  names("--train", f.calibration.conditions, "conditions to train on (see --list)");
  app.add_option("--runs", f.calibration.runs, "of 30 s, for each of them")
      ->check(CLI::Range(1, 10000).description(""))
      ->capture_default_str()
      ->type_name("N");
  names("--conditions", f.study.conditions, "only these (see --list)");
  names("--estimators", f.study.estimators, "only these (see tauext-record --list)");
  names("--detectors", f.study.detectors, "only these");
  app.add_option("--collisions", f.study.blows, "blows, at least, for each condition")
      ->check(CLI::Range(0, 100000).description(""))
      ->capture_default_str()
      ->type_name("N");
  app.add_option("--pushes", f.study.brisk_pushes, "brisk pushes, likewise")
      ->check(CLI::Range(0, 100000).description(""))
      ->capture_default_str()
      ->type_name("N");
  app.add_option("--clampings", f.study.clampings, "soft clampings, likewise")
      ->check(CLI::Range(0, 100000).description(""))
      ->capture_default_str()
      ->type_name("N");
  app.add_option("--hours", f.study.hours, "of free motion and slow pushes, likewise")
      ->capture_default_str();
  app.add_option("--seed", f.study.first_seed, "of the first run; the next ones follow")
      ->check(CLI::Range(std::uint64_t{0}, kTrainingSeed - 1).description(""))
      ->capture_default_str()
      ->type_name("N");
  app.add_option("--jobs", f.study.threads, "threads; 0: one a core")
      ->check(CLI::Range(0, 1024).description(""))
      ->capture_default_str()
      ->type_name("N");
  app.add_flag("--list", f.list, "list the conditions, and stop");
  return run_program(app, argc, argv, [&] { return run(f); });
}
