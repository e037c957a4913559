// SPDX-License-Identifier: Apache-2.0
#include "bench/seeds/golden.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <set>
#include <stdexcept>
#include <utility>

#include "bench/roster/robots.h"
#include "bench/score/degradation.h"
#include "bench/seeds/seeds.h"

namespace tauext {
namespace {

std::string text_of(double value) {
  return !std::isfinite(value) ? "never" : fmt::format("{:.17g}", value);
}

constexpr const char* kAlsoDegraded[] = {"step", "collision"};  // scenarios of any robot

// by entry, by metric, by seed
using Table = std::map<std::string, std::map<std::string, std::vector<double>>>;

class Golden {
 public:
  explicit Golden(const GoldenOptions& o) : o_(o) {
    const auto wanted = entry_filter(o.filter);
    const auto add = [&](const Entry& e, const char* how) {
      if (wanted(name_of(e, how))) entries_[how].push_back(e);
    };
    for (const Entry& e : golden_entries(o.selection)) {
      add(e, "");
      if (also_degraded(e)) add(e, kDegraded);
    }
    if (entries_.empty()) fail_no_match(o.filter);
    if (o.seeds.empty()) throw std::invalid_argument("golden metrics need a seed");
  }

  std::string run() {
    double done = 0;
    for (const auto& [how, entries] : entries_) {
      const double share = 1. / static_cast<double>(entries_.size());
      SeedOptions s{suite_options(how), entries, o_.seeds, o_.threads, {}};
      if (o_.progress) s.progress = [&](double part) { o_.progress(done + share * part); };
      for (const SeededRow& row : score_over_seeds(s)) put(row, name_of(row.entry, how));
      done += share;
    }
    return text();
  }

 private:
  // with sensors that somebody asked for there is nothing to add
  bool own_sensors() const {
    return !o_.suite.sensors.ideal() || !(o_.suite.model_error == ModelError());
  }
  bool also_degraded(const Entry& e) const {
    const auto* const end = std::end(kAlsoDegraded);
    return !own_sensors() && std::find(std::begin(kAlsoDegraded), end, e.scenario().name) != end;
  }
  static std::string name_of(const Entry& e, const std::string& how) {
    return e.group() + how + e.name().substr(e.group().size());
  }

  SuiteOptions suite_options(const std::string& how) const {
    SuiteOptions s = o_.suite;
    if (s.sensors.ideal()) s.sensors = how == kDegraded ? degraded_sensors() : golden_sensors();
    return s;
  }

  void put(const SeededRow& row, const std::string& name) {
    for (std::size_t seed = 0; seed < row.scores.size(); ++seed) {
      Score score = row.scores[seed];
      score.set(Metric::kFailed, score.error.empty() ? 0 : 1);
      const auto put = [&](const std::string& key, double value) {
        auto& values = table_[name][key];
        values.resize(row.scores.size(), std::nan(""));
        values[seed] = value;
      };
      for (const MetricRow& metric : kMetrics) {
        const auto value = score.get(metric.metric);
        if (!metric.is(MetricRow::kGate) || !value) continue;
        put(key_of(metric.metric), *value);
        const Score::Joints& joints = score.joints(metric.metric);
        if (!metric.is(MetricRow::kGateJoints) || joints.size() < 2) continue;
        for (std::size_t j = 0; j < joints.size(); ++j) {
          if (joints[j]) put(key_of(metric.metric, static_cast<int>(j) + 1), *joints[j]);
        }
      }
    }
  }

  std::string text() const {
    std::set<std::string> contacts;
    for (const auto& [how, entries] : entries_) {
      for (const Entry& e : entries) {
        if (e.scenario().has_obstacle()) contacts.insert(e.group() + how);
      }
    }
    const auto described = [&](const std::string& how) {
      Sensors sensors = suite_options(how).sensors;
      sensors.seed = o_.seeds.front();
      return describe({sensors, o_.suite.model_error, o_.suite.recording.drives});
    };
    std::string out = fmt::format(
        "# tauext golden metrics 2\n# mujoco: {}\n# sensors: {}\n{}# contacts: {}\n# built: {}\n"
        "entry\tmetric\tseed {}\n",
        mujoco_version(), described(""),
        own_sensors() ? "" : fmt::format("# degraded: {}\n", described(kDegraded)),
        fmt::join(contacts, " "), o_.built, fmt::join(o_.seeds, "\tseed "));
    for (const auto& [entry, metrics] : table_) {
      for (const auto& [metric, values] : metrics) {
        std::vector<std::string> texts;
        for (const double value : values) texts.push_back(text_of(value));
        out += fmt::format("{}\t{}\t{}\n", entry, metric, fmt::join(texts, "\t"));
      }
    }
    return out + "# end\n";
  }

  const GoldenOptions& o_;
  std::map<std::string, std::vector<Entry>> entries_;  // by "" or kDegraded
  Table table_;
};

}  // namespace

Sensors golden_sensors() {
  Sensors s;
  s.velocity_noise = 1e-3;
  s.encoder_step = 4.8e-5;
  return s;
}

Sensors degraded_sensors() {
  Sensors s;
  s.velocity_noise = 1e-2;  // [rad/s] ten times that of a good one
  s.encoder_step = 4e-4;    // [rad] 14 bits: 2 pi / 2^14
  // [1], [N], [1] of full scale, [1] of full scale, [N], [N]
  s.loadcell = {.scale = 1.01,
                .offset = 2,
                .hysteresis = 0.002,
                .nonlinearity = 0.002,
                .noise = 1,
                .step = 0.5};
  s.latency = 1e-3;  // [s] a sample
  s.jitter = 2e-4;   // [s] a fifth of one
  s.dropped = s.repeated = 0.01;
  return s;
}

std::vector<Entry> golden_entries(const Selection& selection) {
  std::vector<Entry> all = entries(selection);
  if (!selection.empty()) return all;
  std::set<std::string> known;
  for (const Entry& e : all) known.insert(e.name());
  for (const Robot* robot : robots_of(selection)) {
    for (const std::string& d : robot->detectors()) {
      for (Entry& e :
           entries({.robot = selection.robot, .estimators = {"ekf"}, .detectors = {d}})) {
        if (known.insert(e.name()).second) all.push_back(std::move(e));
      }
    }
  }
  return all;
}

std::string golden_metrics(const GoldenOptions& o) {
  return Golden(o).run();
}

}  // namespace tauext
