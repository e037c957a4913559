// SPDX-License-Identifier: Apache-2.0
#include "bench/seeds/seeds.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "bench/score/parallel.h"

namespace tauext {
namespace {

// of one robot and scenario, whose truth is recorded once
struct Group {
  std::vector<std::size_t> rows;
  double cost = 0;  // [s] simulated, by all entries
};

std::vector<Group> groups_of(const std::vector<Entry>& entries) {
  std::map<std::string, Group> by_name;
  for (std::size_t i = 0; i < entries.size(); ++i) {
    Group& g = by_name[entries[i].group()];
    g.rows.push_back(i);
    g.cost += entries[i].scenario().duration;
  }
  std::vector<Group> all;
  for (auto& [name, group] : by_name) all.push_back(std::move(group));
  // the dearest first, so that no thread is left alone at the end
  std::stable_sort(all.begin(), all.end(),
                   [](const auto& a, const auto& b) { return a.cost > b.cost; });
  return all;
}

}  // namespace

SeedScorer::SeedScorer(const SuiteOptions& suite, std::vector<std::uint64_t> seeds, int threads)
    : options_(suite), seeds_(std::move(seeds)), threads_(threads) {
  if (seeds_.empty()) throw std::invalid_argument("scores over seeds need a seed");
}

std::vector<SeededRow> SeedScorer::operator()(const std::vector<Entry>& entries,
                                              const std::function<void(double)>& progress) {
  std::vector<SeededRow> rows;
  for (const Entry& e : entries) rows.push_back({e, std::vector<Score>(seeds_.size())});
  const std::vector<Group> groups = groups_of(entries);
  // fewer groups than threads: several take turns with the seeds of a group
  const auto threads = static_cast<std::size_t>(thread_count(threads_));
  const std::size_t turns =
      groups.empty() ? 1 : std::min((threads + groups.size() - 1) / groups.size(), seeds_.size());
  std::vector<Suite*> suites;  // all places exist before threads look for them
  for (const Group& g : groups) {
    auto& of_group = suites_[entries[g.rows.front()].group()];
    for (std::size_t turn = 0; turn < turns; ++turn) {
      if (turn == of_group.size()) of_group.push_back(std::make_unique<Suite>(options_));
      suites.push_back(of_group[turn].get());
    }
  }
  const auto work = [&](int i) {
    const auto job = static_cast<std::size_t>(i);
    Suite& suite = *suites[job];
    for (std::size_t seed = job % turns; seed < seeds_.size(); seed += turns) {
      Sensors sensors = options_.sensors;
      sensors.seed = seeds_[seed];
      suite.set_sensors(sensors);
      for (const std::size_t row : groups[job / turns].rows)
        rows[row].scores[seed] = suite.score(rows[row].entry);
    }
  };
  parallel_for(static_cast<int>(suites.size()), threads_, work, progress);
  return rows;
}

std::vector<SeededRow> score_over_seeds(const SeedOptions& o) {
  return SeedScorer(o.suite, o.seeds, o.threads)(o.entries, o.progress);
}

}  // namespace tauext
