// SPDX-License-Identifier: Apache-2.0
#include "bench/tune/tune_conditions.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cstdio>
#include <filesystem>
#include <sstream>
#include <stdexcept>

#include "bench/program/interrupt.h"
#include "bench/program/program.h"
#include "bench/study/detection/tuned.h"
#include "bench/tune/study_tuning.h"
#include "mjcf/trace/atomic_file.h"
#include "mjcf/trace/input_file.h"
#include "mjcf/trace/printable.h"
#include "mjcf/trace/table_writer.h"

namespace tauext {
namespace {

// the texts between commas
std::vector<std::string> list_of(const std::string& text) {
  std::vector<std::string> all;
  std::istringstream in(text);
  for (std::string item; std::getline(in, item, ',');) all.push_back(item);
  return all;
}

std::string command_of(const ConditionsToTune& f) {
  std::string text = "tauext-tune";
  if (!f.robot.empty()) text += " --robot " + f.robot;
  text +=
      fmt::format(" --conditions {} --evaluations {}", fmt::join(f.conditions, ","), f.evaluations);
  if (!f.estimators.empty()) text += " --estimator " + f.estimators;
  if (!f.detectors.empty()) text += " --detector " + f.detectors;
  return text + " --out " + f.out;
}

}  // namespace

int tune_conditions(const ConditionsToTune& f) {
  if (f.out.empty())
    throw std::invalid_argument("--conditions needs --out FILE.json, for pairs and thresholds");
  study::TunedStudy all;
  if (std::filesystem::exists(f.out)) {
    all = study::read_tuned(f.out);
    release_input(f.out);
  }
  { const AtomicFile probe(f.out); }  // an unwritable path should not cost a run
  const TableFormat format = table_format(f.format);
  const Interrupt interrupt;
  Progress progress("tuning");
  StudyTuning o;
  o.robot = f.robot;
  o.conditions = f.conditions;
  o.estimators = list_of(f.estimators);
  o.detectors = list_of(f.detectors);
  o.evaluations = f.evaluations;
  o.progress = progress.callback();
  o.stop = [&] { return interrupt.seen(); };
  study::TunedStudy more = tune_study(o, all.rows);
  progress.clear();
  if (more.rows.empty()) {
    say(f.out + (interrupt.seen() ? ": stopped; nothing was finished that is not in it"
                                  : ": has all of these pairs already"));
    return interrupt.seen() ? kInterrupted : int{kGood};
  }
  more.made_by = command_of(f);
  append(more, all);
  study::write_tuned(all, f.out);
  TableWriter table({{"condition", "", true},
                     {"before", "", true},
                     {"recall", "%"},
                     {"tuned", "", true},
                     {"recall", "%"},
                     {"evaluations", ""}});
  for (const study::TunedRow& p : more.rows)
    table.add({p.condition, p.before, fmt::format("{:.1f}", 100 * p.recall_before),
               p.estimator + "+" + p.detector, fmt::format("{:.1f}", 100 * p.recall),
               fmt::to_string(p.evaluations)});
  fmt::print("{}", table.format(format));
  if (interrupt.seen()) say("stopped; the same command goes on from here");
  return interrupt.seen() ? kInterrupted : int{kGood};
}

}  // namespace tauext
