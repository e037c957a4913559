// SPDX-License-Identifier: Apache-2.0
#include "bench/score/golden.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <map>
#include <mutex>
#include <regex>
#include <set>
#include <stdexcept>
#include <utility>

#include "bench/roster/robots.h"
#include "bench/score/degradation.h"
#include "bench/score/parallel.h"

namespace tauext {
namespace {

std::string text_of(double value) {
  return !std::isfinite(value) ? "never" : fmt::format("{:.17g}", value);
}

// the suite's, and unless somebody selects, each detector that stands in the studies alone behind
// the paper's first estimator
std::vector<Entry> all_entries(const Selection& selection) {
  std::vector<Entry> all = entries(selection);
  if (!selection.empty()) return all;
  std::set<std::string> known;
  for (const Entry& e : all) known.insert(e.name());
  for (const auto& robot : robots()) {
    for (const std::string& d : robot->detectors()) {
      for (Entry& e : entries({.estimators = {"ekf"}, .detectors = {d}})) {
        if (known.insert(e.name()).second) all.push_back(std::move(e));
      }
    }
  }
  return all;
}

// by entry, by metric, by seed
using Table = std::map<std::string, std::map<std::string, std::vector<double>>>;

class Golden {
 public:
  explicit Golden(const GoldenOptions& o) : o_(o) {
    std::regex wanted;
    try {
      wanted = std::regex(o.filter);
    } catch (const std::regex_error& e) {
      throw std::invalid_argument(
          fmt::format("'{}' is no regular expression: {}", o.filter, e.what()));
    }
    for (const Entry& e : all_entries(o.selection)) {
      if (std::regex_search(e.name(), wanted)) groups_[e.group()].push_back(e);
    }
    if (groups_.empty()) {
      throw std::invalid_argument(
          fmt::format("the filter '{}' matches nothing; see --list", o.filter));
    }
    if (o.seeds.empty()) throw std::invalid_argument("golden metrics need a seed");
    for (const auto& [name, ignored] : groups_) {
      for (std::size_t s = 0; s < o.seeds.size(); ++s) jobs_.emplace_back(name, s);
    }
  }

  std::string run() {
    parallel_for(
        static_cast<int>(jobs_.size()), o_.threads,
        [&](int i) { score(jobs_[static_cast<std::size_t>(i)]); }, o_.progress);
    return text();
  }

 private:
  SuiteOptions options(std::size_t seed) const {
    SuiteOptions s = o_.suite;
    if (s.sensors.ideal()) s.sensors = golden_sensors();
    s.sensors.seed = o_.seeds[seed];
    return s;
  }

  void score(const std::pair<std::string, std::size_t>& job) {
    Suite suite(options(job.second));
    for (const Entry& e : groups_.at(job.first)) {
      Score score = suite.score(e);
      score.set(Metric::kFailed, score.error.empty() ? 0 : 1);
      const std::lock_guard lock(mutex_);
      const auto put = [&](const std::string& key, double value) {
        auto& values = table_[e.name()][key];
        values.resize(o_.seeds.size(), std::nan(""));
        values[job.second] = value;
      };
      for (const MetricRow& metric : kMetrics) {
        const auto value = score.get(metric.metric);
        if (!metric.is(MetricRow::kGate) || !value) continue;
        put(key_of(metric.metric), *value);
        const std::vector<double>& joints = score.joints(metric.metric);
        if (!metric.is(MetricRow::kGateJoints) || joints.size() < 2) continue;
        for (std::size_t j = 0; j < joints.size(); ++j) {
          put(key_of(metric.metric, static_cast<int>(j) + 1), joints[j]);
        }
      }
    }
  }

  std::string text() const {
    const Sensors sensors = options(0).sensors;
    std::set<std::string> contacts;
    for (const auto& [group, rivals] : groups_) {
      const Entry& e = rivals.front();
      if (e.scenario().has_obstacle()) {
        contacts.insert(e.robot().name() + "/" + e.scenario().name);
      }
    }
    std::string out = fmt::format(
        "# tauext golden metrics 2\n# mujoco: {}\n# sensors: {}\n# contacts: {}\n# built: {}\n"
        "entry\tmetric\tseed {}\n",
        mujoco_version(), describe({sensors, o_.suite.model_error}), fmt::join(contacts, " "),
        o_.built, fmt::join(o_.seeds, "\tseed "));
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
  std::map<std::string, std::vector<Entry>> groups_;
  std::vector<std::pair<std::string, std::size_t>> jobs_;  // group and number of the seed
  Table table_;
  std::mutex mutex_;  // of table_
};

}  // namespace

Sensors golden_sensors() {
  Sensors s;
  s.velocity_noise = 1e-3;
  s.encoder_step = 4.8e-5;
  return s;
}

std::string golden_metrics(const GoldenOptions& o) {
  return Golden(o).run();
}

}  // namespace tauext
