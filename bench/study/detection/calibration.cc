// SPDX-License-Identifier: Apache-2.0
#include "bench/study/detection/calibration.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <functional>
#include <map>
#include <memory>
#include <set>
#include <span>
#include <stdexcept>
#include <utility>

#include "bench/roster/robots.h"
#include "bench/score/detection_metrics.h"
#include "bench/study/detection/training.h"
#include "bench/study/study_runs.h"

namespace tauext::study {
namespace {

void require_free(const FreeRecording& r, const Robot& robot) {
  const Trace& t = r.trace;
  const auto fail = [&](const std::string& why) {
    throw std::invalid_argument(fmt::format("{}: {}", r.name, why));
  };
  robot.require_joints(t, r.name);
  const double length = watched(t);
  if (length < 2 * kScoreFrom)
    fail(fmt::format("{:.3g} s long; {:g} s are needed, of which the first {:g} do not count",
                     length, 2 * kScoreFrom, kScoreFrom));
  const auto contact =
      std::find_if(t.contact.begin(), t.contact.end(), [](auto c) { return c != 0; });
  if (contact != t.contact.end())
    fail(fmt::format(
        "something touches the arm at {:g} s; thresholds come from recordings without contact",
        t.t[static_cast<std::size_t>(contact - t.contact.begin())]));
}

// from runs of these conditions, as sensors of these qualities see them
Thresholds calibrated(const StudyRuns& runs, const std::vector<std::string>& names,
                      const std::vector<Quality>& qualities, const CalibrationOptions& o) {
  if (o.runs < 1) throw std::invalid_argument("calibration needs at least one run");
  const Robot& r = *runs.robot;
  std::map<double, std::shared_ptr<const Robot>> believers;
  for (const std::string& name : names) {
    const double believed = condition(runs, name).believed;
    if (!believers.contains(believed)) believers[believed] = runs.believer(believed);
  }
  // a batch has runs of one condition
  const int count = static_cast<int>(names.size()), most = r.runs_at_once();
  const int batches_of_one = (o.runs + most - 1) / most;
  const auto show = [&](int batch, const Look& look) {
    const int which_name = batch % count, from = batch / count * most;
    const Condition& c = condition(runs, names[static_cast<std::size_t>(which_name)]);
    const PlantKey plant = plant_of(c);
    const Model model = runs.model(plant);
    std::vector<Job> jobs;
    std::vector<int> which;
    for (int i = from; i < std::min(from + most, o.runs); ++i) {
      which.push_back(i * count + which_name);
      jobs.push_back({plant, TouchKind::kSlowPush, kTrainingSeed + static_cast<std::uint64_t>(i)});
    }
    Views views(simulated(runs, jobs, model), jobs);
    for (std::size_t set = 0; set < qualities.size(); ++set) {
      Sensors sensors = c.degradation.sensors;
      sensors.velocity_noise = qualities[set].velocity_noise;
      const std::vector<Trace> seen = views.by(sensors, c.every);
      look({set, *believers.at(c.believed), seen, which, ""});
    }
  };
  return train(o, r, {count * o.runs, count * batches_of_one, show}, qualities,
               fmt::format("{}, {}: {} runs each of free motion and slow pushes, seeds from {} on",
                           r.name(), fmt::join(names, ", "), o.runs, kTrainingSeed));
}

}  // namespace

double watched(const Trace& t) {
  metrics::DetectionCounter counter;
  for (const double at : t.t) counter.take(at, false, false);
  return counter.score().watched;
}

Thresholds calibrate(const CalibrationOptions& o) {
  const StudyRuns& runs = touched_runs(o.robot);
  const std::vector<std::string> names = chosen_conditions(runs, o.conditions, runs.training);
  std::set<double> noises = {1e-4, 1e-3};
  for (const std::string& name : names)
    noises.insert(condition(runs, name).degradation.sensors.velocity_noise);
  std::vector<Quality> qualities;
  for (const double noise : noises) qualities.push_back({noise, ""});
  return calibrated(runs, names, qualities, o);
}

bool are_for(const Thresholds& t, const Robot& r, const std::string& condition) {
  const ThresholdSet* const set = t.of(r.name(), 0, r.fingerprint(), condition);
  return set != nullptr && set->condition == condition;
}

Thresholds calibrate_for(const std::vector<std::string>& conditions, const CalibrationOptions& o) {
  const StudyRuns& runs = touched_runs(o.robot);
  const std::vector<std::string> names = chosen_conditions(runs, o.conditions, conditions);
  std::vector<std::string> itself, rest;
  for (const std::string& name : names)
    (condition(runs, name).trains_itself ? itself : rest).push_back(name);
  const bool others = names.empty() || !rest.empty();
  const auto parts = static_cast<double>(itself.size() + others);
  CalibrationOptions of_part = o;
  if (!o.conditions.empty()) of_part.conditions = rest;
  double begun = 0;
  if (o.progress) of_part.progress = [&](double share) { o.progress((begun + share) / parts); };
  Thresholds all;
  if (others) all = calibrate(of_part), ++begun;
  for (const std::string& name : itself) {
    const double noise = condition(runs, name).degradation.sensors.velocity_noise;
    const Thresholds one = calibrated(runs, {name}, {{noise, name}}, of_part);
    all.margin = one.margin;
    all.trained_on += (all.trained_on.empty() ? "" : "; ") + one.trained_on;
    all.sets.push_back(one.sets.front());
    ++begun;
  }
  return all;
}

ThresholdSet calibrate_on(const Robot& r, std::span<const EstimatedRuns> batches,
                          const CalibrationOptions& o) {
  int runs = 0;
  std::vector<std::vector<int>> which;
  for (const EstimatedRuns& batch : batches) {
    which.emplace_back();
    for (std::size_t i = 0; i < batch.traces.size(); ++i) which.back().push_back(runs++);
  }
  const auto show = [&](int i, const Look& look) {
    const auto at = static_cast<std::size_t>(i);
    look({0, r, batches[at].traces, which[at], "", batches[at].session.get()});
  };
  return train(o, r, {runs, static_cast<int>(batches.size()), show}, {{}}, "").sets.front();
}

Thresholds calibrate_on(const Robot& r, const std::vector<FreeRecording>& recordings,
                        const CalibrationOptions& o, std::vector<HeldOut>& held_out) {
  if (recordings.empty()) throw std::invalid_argument("no recording to calibrate from");
  double seconds = 0;
  std::vector<std::string> names;
  for (const FreeRecording& x : recordings) {
    require_free(x, r);
    seconds += watched(x.trace) - kScoreFrom;
    names.push_back(x.name);
  }
  const auto show = [&](int i, const Look& look) {
    const FreeRecording& x = recordings[static_cast<std::size_t>(i)];
    look({0, r, {&x.trace, 1}, {i}, x.name});
  };
  const int count = static_cast<int>(recordings.size());
  return train(o, r, {count, count, show}, {{}},
               fmt::format("{}, {:.0f} s of {}", r.name(), seconds, fmt::join(names, ", ")),
               &held_out);
}

}  // namespace tauext::study
