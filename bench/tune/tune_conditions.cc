// SPDX-License-Identifier: Apache-2.0
#include "bench/tune/tune_conditions.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <sstream>
#include <stdexcept>

#include "bench/program/interrupt.h"
#include "bench/program/program.h"
#include "bench/score/table.h"
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
  return text + " --out FILE.json";  // whose name says nothing, nor that it was made in parts
}

}  // namespace

int tune_conditions(const ConditionsToTune& f) {
  if (f.out.empty())
    throw std::invalid_argument("--conditions needs --out FILE.json, for pairs and thresholds");
  const TableFormat format = table_format(f.format);
  const auto known = [&] {
    if (!std::filesystem::exists(f.out)) return study::TunedStudy();
    study::TunedStudy all = study::read_tuned(f.out);
    release_input(f.out);
    return all;
  };
  { const AtomicFile probe(f.out); }  // an unwritable path should not cost a run
  const Interrupt interrupt;
  std::atomic<bool> told = false;
  std::vector<study::TunedRow> rows;
  Progress progress("tuning");
  StudyTuning o;
  o.robot = f.robot;
  o.conditions = f.conditions;
  o.estimators = list_of(f.estimators);
  o.detectors = list_of(f.detectors);
  o.evaluations = f.evaluations;
  if (!f.shard.empty()) o.shard = study::shard_of(f.shard);
  o.progress = progress.callback();
  o.stop = [&] {
    if (interrupt.seen() && !told.exchange(true))
      say("stopping: what was tuned gets its thresholds first, which takes a minute");
    return interrupt.seen();
  };
  o.found = [&](const study::TunedStudy& more) {
    study::TunedStudy all = known();  // as it is now: somebody else may have added to it
    study::TunedStudy adds = more;
    adds.made_by = command_of(f);
    append(adds, all);
    study::write_tuned(all, f.out);
    rows.insert(rows.end(), more.rows.begin(), more.rows.end());
  };
  tune_study(o, known().rows);
  progress.clear();
  TableWriter table({{"condition", "", true},
                     {"before", "", true},
                     {"recall", "%"},
                     {"tuned", "", true},
                     {"recall", "%"},
                     {"evaluations", ""}});
  const auto share = [](double x) { return std::isnan(x) ? "-" : percent(x, 1); };
  for (const study::TunedRow& p : rows)
    table.add({p.condition, p.before, share(p.recall_before), p.estimator + "+" + p.detector,
               share(p.recall), fmt::to_string(p.evaluations)});
  if (rows.empty())
    say(f.out + ": nothing was added: it has all of these pairs that make estimates");
  else
    fmt::print("{}", table.format(format));
  if (told) say("stopped; the same command goes on from here");
  return told ? kInterrupted : int{kGood};
}

int merge_tuned(const std::vector<std::string>& paths, const std::string& out) {
  study::TunedStudy all;
  for (const std::string& path : paths) {
    const study::TunedStudy more = study::read_tuned(path);
    if (more.rows.empty())
      throw std::runtime_error(path + ": has no pairs that tauext-tune --conditions has tuned");
    for (const study::TunedRow& p : more.rows) {
      if (std::any_of(all.rows.begin(), all.rows.end(), [&](const study::TunedRow& k) {
            return k.robot == p.robot && k.arm == p.arm && k.condition == p.condition &&
                   k.before == p.before;
          }))
        throw std::runtime_error(fmt::format("{}: {} for {} on {} is in a file before it, too",
                                             path, p.before, p.condition, p.robot));
    }
    append(more, all);
  }
  study::write_tuned(all, out);
  say(fmt::format("{}: {} pairs", out, all.rows.size()));
  return kGood;
}

}  // namespace tauext
