// SPDX-License-Identifier: Apache-2.0
#include "bench/detect_main.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <iterator>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "bench/program/interrupt.h"
#include "bench/program/program.h"
#include "bench/replay/robot_log.h"
#include "bench/report/provenance.h"
#include "bench/roster/robots.h"
#include "bench/roster/threshold_file.h"
#include "bench/score/detection_metrics.h"
#include "bench/study/detection/calibration.h"
#include "bench/study/detection/detection_report.h"
#include "bench/study/detection/detection_study.h"
#include "bench/study/detection/study_parts.h"
#include "bench/study/detection/tuned.h"
#include "bench/study/study_runs.h"
#include "mjcf/trace/atomic_file.h"
#include "mjcf/trace/known.h"
#include "mjcf/trace/printable.h"
#include "mjcf/trace/table_writer.h"

namespace tauext {
namespace {

struct Flags {
  study::StudyOptions study;
  study::CalibrationOptions calibration;
  std::vector<std::string> logs;   // to calibrate from
  std::vector<std::string> parts;  // of a study
  std::string robot, lock, channel, columns, contacts, calibrate_to, thresholds, out, shard,
      format = "text";
  bool list = false, quick = false;
};

int list_conditions(const study::StudyRuns& runs) {
  TableWriter table({{"condition", "", true}, {"what is so", "", true}});
  for (const study::Condition& c : runs.conditions) {
    const bool trained = std::count(runs.training.begin(), runs.training.end(), c.name) > 0;
    table.add({c.name, c.description + (trained           ? " (trained on)"
                                        : c.trains_itself ? " (trained on itself)"
                                                          : "")});
  }
  fmt::print("{}\n{}", table.format(), list_fields(runs.robot));
  return kGood;
}

study::CalibrationOptions calibration_of(const Flags& f, Progress& progress) {
  study::CalibrationOptions o = f.calibration;
  o.robot = f.study.robot, o.threads = f.study.threads;
  o.estimators = f.study.estimators, o.detectors = f.study.detectors;
  o.progress = progress.callback();
  return o;
}

constexpr const char* kOneRecording =
    "With one recording nobody can say whether these thresholds hold on another.\n";
constexpr const char* kHeldOutLegend =
    "\n{}alarms: recordings in which the thresholds of all others would mark (the metric by which "
    "`clamping` weighs the joints has seen all of them).\n";

// what its contacts leave of a recording, in stretches: from metrics::kGrace after a contact to the
// next one. Those that are too short to train on are left out
std::vector<study::FreeRecording> free_stretches(const std::string& path, const Trace& trace) {
  std::vector<study::FreeRecording> all;
  std::vector<int> samples;
  int left_out = 0;
  double seconds = 0;  // of all
  const auto end = [&] {
    if (samples.empty()) return;
    Trace part = select_samples(trace, samples);
    samples.clear();
    const double length = study::watched(part);
    if (length < 2 * study::kScoreFrom) {
      ++left_out;
      return;
    }
    seconds += length;
    all.push_back({fmt::format("{} from {:g} to {:g} s", path, part.t.front(), part.t.back()),
                   std::move(part)});
  };
  double last = -std::numeric_limits<double>::infinity();  // [s] of a contact
  for (int k = 0; k < trace.size(); ++k) {
    const auto at = static_cast<std::size_t>(k);
    const bool touched = trace.contact[at] != 0;
    if (touched) last = trace.t[at];
    if (trace.t[at] > last + metrics::kGrace) {
      samples.push_back(k);
    } else {
      end();
    }
  }
  end();
  say(fmt::format(
      "{}: without its contacts {} stretches, {:.3g} s in all; {} are left out, as they "
      "are shorter than {:g} s",
      path, all.size(), seconds, left_out, 2 * study::kScoreFrom));
  return all;
}

// from recordings without contact; says whether these thresholds would have held
Thresholds calibrated_on_logs(const Flags& f, bool& usable) {
  if (f.study.robot == nullptr)
    throw std::invalid_argument("calibrating from recordings needs --robot NAME or FILE");
  const Robot& r = *f.study.robot;
  std::vector<std::string> files;
  for (const std::string& path : f.logs)
    files.push_back(std::filesystem::weakly_canonical(path).string());
  refuse_twice("recording", files);
  std::vector<study::FreeRecording> recordings;
  const auto contacts = contacts_of(f.contacts, f.logs);
  for (const std::string& path : f.logs) {
    RecordedLog log = robot_log(r, path, f.channel, f.columns, contacts);
    log.require_consistent(path);
    usable = usable && log.usable();
    const std::vector<std::uint8_t>& contact = log.trace.contact;
    if (std::all_of(contact.begin(), contact.end(), [](auto c) { return c == 0; })) {
      recordings.push_back({path, std::move(log.trace)});
      continue;
    }
    for (study::FreeRecording& part : free_stretches(path, log.trace))
      recordings.push_back(std::move(part));
  }
  if (recordings.empty())
    throw std::invalid_argument(
        fmt::format("the recordings have no stretch of {:g} s without contact: record motions in "
                    "which nothing touches the arm",
                    2 * study::kScoreFrom));
  Progress progress("calibrating");
  std::vector<study::HeldOut> held_out;
  const Thresholds thresholds =
      study::calibrate_on(r, recordings, calibration_of(f, progress), held_out);
  TableWriter table({{"estimator", "", true}, {"detector", "", true}, {"alarms", "recordings"}});
  for (const study::HeldOut& h : held_out)
    table.add({h.estimator, h.detector, fmt::format("{} of {}", h.alarms, h.recordings)});
  std::FILE* const to = f.calibrate_to == "-" ? stderr : stdout;
  fmt::print(to, "trained on {}, margin {:g}\n", printable(thresholds.trained_on),
             thresholds.margin);
  if (!held_out.empty()) fmt::print(to, kHeldOutLegend, table.format());
  if (f.logs.size() == 1) fmt::print(to, "{}", kOneRecording);
  return thresholds;
}

// as these conditions want it, if nothing else is asked for
Thresholds calibrated(const Flags& f, const std::vector<std::string>& conditions) {
  Progress progress("calibrating");
  return study::calibrate_for(conditions, calibration_of(f, progress));
}

int run_calibration(const Flags& f) {
  if (f.calibrate_to != "-" && !f.calibrate_to.ends_with(".json"))
    throw std::invalid_argument(fmt::format(
        "--calibrate {}: the name of a file of thresholds ends in .json", f.calibrate_to));
  AtomicFile{f.calibrate_to};  // an unwritable path should not cost a run
  bool usable = true;
  write_thresholds(f.logs.empty() ? calibrated(f, {}) : calibrated_on_logs(f, usable),
                   f.calibrate_to);
  if (f.calibrate_to != "-") say(f.calibrate_to + ": thresholds");
  return usable ? kGood : kAnswerIsNo;
}

// the study's table and its file
void write_study(const Flags& f, const study::StudyAbout& about,
                 const std::vector<study::Cell>& cells) {
  const TableFormat format = table_format(f.format);
  // a table for a program stands alone; so does a study on standard output
  std::FILE* const words = format == TableFormat::kText && f.out != "-" ? stdout : stderr;
  fmt::print(words, "thresholds: {}, margin {:g}; test seeds from {} on\n\n",
             printable(about.trained_on), about.margin, about.plan.at("seed").dump());
  const study::StudyRuns& runs = study::touched_runs(about.robot);
  fmt::print(f.out == "-" ? stderr : stdout, "{}", study::format_study(runs, cells, format));
  if (f.out.empty()) return;
  const Thresholds t{.trained_on = about.trained_on, .margin = about.margin};
  AtomicFile file(f.out);
  file.write(study::study_json(runs, cells, t, about.context));
  file.commit();
  if (f.out != "-") fmt::print(words, "\n{}: all of it as JSON, with points of the ROC\n", f.out);
}

// unless conditions are named: those of --quick; or those that the file of thresholds is for
std::vector<std::string> conditions_of(const Flags& f, const study::StudyRuns& runs,
                                       const Thresholds& t) {
  std::vector<std::string> all = f.quick ? runs.quick : runs.honest;
  if (!f.quick && !f.thresholds.empty()) {
    all.clear();
    for (const study::Condition& c : runs.conditions)
      if (study::are_for(t, *runs.robot, c.name)) all.push_back(c.name);
    if (all.empty()) all = runs.quick;
  }
  return study::chosen_conditions(runs, f.study.conditions, all);
}

int run_study(Flags& f) {
  table_format(f.format);
  if (f.quick && !f.study.conditions.empty())
    throw std::invalid_argument("--quick stands for --conditions: not both");
  study::TunedStudy file;
  if (!f.thresholds.empty()) file = study::read_tuned(f.thresholds);
  f.study.tuned = file.rows;
  f.study.conditions = conditions_of(f, study::touched_runs(f.study.robot), file.thresholds);
  study::check_study(f.study);  // before calibration takes its time
  const bool part = !f.shard.empty();
  const study::Shard shard = part ? study::shard_of(f.shard) : study::Shard();
  if (part && (f.out.empty() || f.out == "-"))
    throw std::invalid_argument("--shard needs --out FILE, to which the part goes");
  if (!f.out.empty() && !part) AtomicFile{f.out};
  const Thresholds thresholds =
      f.thresholds.empty() ? calibrated(f, f.study.conditions) : file.thresholds;
  study::StudyAbout about = study::about(f.study, thresholds);
  about.context = provenance(fmt::format("seeds from {}", f.study.first_seed));
  const study::DetectionStudy study(f.study, thresholds);
  const Interrupt interrupt;
  Progress progress("studying");
  f.study.progress = progress.callback();
  f.study.stop = [&] { return interrupt.seen(); };
  if (part) {
    const bool whole = study::run_part(study, about, shard, f.out, f.study);
    progress.clear();
    say(whole ? fmt::format("{}: part {}", f.out, f.shard)
              : fmt::format("{}: stopped; the same command goes on from here", f.out));
    return whole ? int{kGood} : kInterrupted;
  }
  study::StudySum sum(study.cells());
  study::run_pieces(study, f.study, sum);
  progress.clear();
  const bool whole = sum.pieces() == study.pieces();
  if (!whole) {
    const std::string how_far =
        fmt::format("after {} of {} pieces of work", sum.pieces(), study.pieces());
    say(fmt::format("stopped {}: what is done so far", how_far));
    about.context.emplace_back("stopped", how_far);
  }
  write_study(f, about, sum.sorted());
  return whole ? int{kGood} : kInterrupted;
}

int merge(const Flags& f) {
  table_format(f.format);
  const study::Merged m = study::merge_parts(f.parts);
  if (!f.out.empty()) AtomicFile{f.out};  // a path that cannot be written, or one of the parts
  write_study(f, m.about, m.cells);
  return kGood;
}

int run(const CLI::App& app, Flags& f) {
  if (!f.robot.empty() || !f.lock.empty()) f.study.robot = &robot(f.robot, f.lock);
  if (f.list) return list_conditions(study::touched_runs(f.study.robot));
  const bool studies = f.calibrate_to.empty();
  require_mode(app, studies, "a study, not with --calibrate",
               {"--thresholds", "--out", "--format", "--conditions", "--collisions", "--pushes",
                "--clampings", "--regions", "--hours", "--seed", "--quick", "--shard"});
  require_mode(app, f.shard.empty(), "the table of all parts: merge", {"--format"});
  require_mode(app, f.thresholds.empty(), "training, not with --thresholds", {"--margin"});
  require_mode(app, f.thresholds.empty() && f.logs.empty(),
               "training on simulated runs, not with --thresholds or recordings",
               {"--train", "--runs"});
  require_mode(app, !f.logs.empty(), "recordings to calibrate from",
               {"--columns", "--channel", "--contacts"});
  if (studies && !f.logs.empty())
    throw std::invalid_argument(f.logs[0] + ": recordings are for --calibrate FILE");
  return studies ? run_study(f) : run_calibration(f);
}

template <class T>
CLI::Option* add_count(CLI::App& app, const char* flag, T& to, T least, T most, const char* help) {
  return app.add_option(flag, to, help)
      ->check(CLI::Range(least, most).description(""))
      ->capture_default_str()
      ->type_name("N");
}

void add_names(CLI::App& app, const char* flag, std::vector<std::string>& to, const char* help) {
  app.add_option(flag, to, help)->delimiter(',')->allow_extra_args(false)->type_name("NAME,..");
}

void add_flags(CLI::App& app, Flags& f) {
  app.add_option("logs", f.logs, "without contact, to --calibrate (--columns, --contacts: replay)");
  app.add_option("--channel", f.channel)->group("");
  app.add_option("--columns", f.columns)->group("");
  app.add_option("--contacts", f.contacts)->group("")->check(not_empty);
  app.add_option("--calibrate", f.calibrate_to,
                 "set the thresholds from training runs, write, stop")
      ->type_name("FILE.json")
      ->check(not_empty);
  app.add_option("--margin", f.calibration.margin, "threshold over the largest value in training")
      ->capture_default_str();
  app.add_option("--thresholds", f.thresholds,
                 "file of --calibrate, or of tauext-tune --conditions")
      ->type_name("FILE.json")
      ->check(not_empty);
  app.add_option("--out", f.out, "JSON of it all, with the ROC; --format csv|md|latex: the table")
      ->type_name("FILE");
  app.add_option("--format", f.format)->group("");
  app.add_option("--robot", f.robot,
                 "wallmobot3, another, or a file of MJCF or URDF (with --lock REGEX)")
      ->type_name("NAME|FILE");
  app.add_option("--lock", f.lock)->group("")->check(not_empty);
  add_names(app, "--train", f.calibration.conditions,
            "conditions to train on, each in --runs 20 of 30 s");
  add_count(app, "--runs", f.calibration.runs, 1, 10000, "")->group("");
  add_names(app, "--conditions", f.study.conditions,
            "only these (see --list); --quick: good sensors, blows");
  app.add_flag("--quick", f.quick)->group("");
  add_names(app, "--estimator", f.study.estimators, "only these, like mo2:bandwidth=50,ekf");
  add_names(app, "--detector", f.study.detectors, "only these, like high_pass:w=60");
  add_count(app, "--collisions", f.study.blows, 0, 100000,
            "blows of a condition, at least; --pushes, --clampings, --regions");
  add_count(app, "--pushes", f.study.brisk_pushes, 0, 100000, "")->group("");
  add_count(app, "--clampings", f.study.clampings, 0, 100000, "")->group("");
  add_count(app, "--regions", f.study.regions, 0, 100000, "")->group("");
  app.add_option("--hours", f.study.hours, "of free motion and slow pushes, at least")
      ->capture_default_str();
  add_count(app, "--seed", f.study.first_seed, std::uint64_t{0}, study::kTrainingSeed - 1,
            "seed of the first run; the next runs count up from it");
  app.add_option("--shard", f.shard,
                 "do the I-th of N parts, to --out; then: merge PART.. --out FILE")
      ->type_name("I/N")
      ->check(not_empty);
  add_count(app, "--jobs", f.study.threads, 0, 1024, "threads; 0: one a core");
  app.add_flag("--list", f.list, "list the conditions and the keys of specifications, and stop");
}

}  // namespace

int detect_main(int argc, char** argv) {
  CLI::App app(
      "Tries every detector behind every estimator of a robot; without --thresholds it "
      "calibrates.\n\n"
      "  tauext-detect --calibrate t.json --robot arm.json --columns ur_rtde free*.csv\n"
      "  tauext-detect --thresholds thresholds.json --conditions known_150 --regions 20\n",
      "tauext-detect");
  app.get_formatter()->column_width(34);
  Flags f;
  add_flags(app, f);
  CLI::App* const merging = app.add_subcommand("merge", "put the parts of --shard together");
  merging->group("")->add_option("parts", f.parts, "their files")->required();
  merging->add_option("--out", f.out, "JSON of it all");
  merging->add_option("--format", f.format, "of the table");
  for (CLI::Option* of_study : app.get_options()) merging->excludes(of_study);
  keep_freed_memory();
  return run_program(app, argc, argv, [&] { return merging->parsed() ? merge(f) : run(app, f); });
}

}  // namespace tauext
