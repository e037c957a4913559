// SPDX-License-Identifier: Apache-2.0
#include "regression/time/time_worker.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <numeric>
#include <random>
#include <stdexcept>
#include <utility>

#include "regression/host/child.h"
#include "regression/host/files.h"
#include "regression/host/plugin_host.h"
#include "regression/time/verdict.h"

namespace tauext::gate {

NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(WorkerOptions, base, head, kernels, seed, rounds, block,
                                   injected)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(WorkerResult, kernel, base_ns, head_ns, head, aa, canaries)

namespace {

constexpr int kTries = 25, kTrySteps = 200;  // to find out how long a step takes

double seconds(Work& w, int steps) {
  const auto begin = std::chrono::steady_clock::now();
  w.run(steps);
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

// steps that take about `block` seconds
int steps_for(Work& w, double block) {
  std::vector<double> tries;
  for (int i = 0; i < kTries; ++i) tries.push_back(seconds(w, kTrySteps));
  const double step = std::max(median(tries), 1e-9) / kTrySteps;
  return std::clamp(static_cast<int>(block / step), 40, 1'000'000);
}

// Base, head, base's copy and base with more steps: each a library and a state of its own, else the
// one that follows another of the same library would find its caches and branch predictors warm.
struct Lane {
  std::unique_ptr<Work> work;
  int steps;
  std::vector<double> times;  // [s] of `steps`, round by round
};

std::vector<Lane> lanes_of(const WorkerOptions& o, const std::vector<Plugin>& plugins, Lives& lives,
                           const std::string& kernel) {
  std::vector<Lane> lanes;
  for (const Plugin& plugin : plugins) {
    const int i = plugin.find(kernel);
    if (i < 0) throw std::runtime_error(kernel + ": not in both plug-ins");
    lanes.push_back({std::make_unique<Work>(plugin, i, lives.of(plugin, i)), 0, {}});
  }
  const int steps = steps_for(*lanes[0].work, o.block);
  // from here on all lanes but the slowed ones see the same samples at the same time
  for (std::size_t i = 0; i < lanes.size(); ++i) {
    const double more = i < 3 ? 0 : o.injected[i - 3];
    lanes[i].steps = static_cast<int>(std::lround(steps * (1 + more)));
    if (i > 0) lanes[i].work->run(kTries * kTrySteps);
  }
  return lanes;
}

double median_ratio(const Lane& of, const Lane& to) {
  std::vector<double> ratios;
  for (std::size_t i = 0; i < of.times.size(); ++i) ratios.push_back(of.times[i] / to.times[i]);
  return median(ratios);
}

WorkerResult run_rounds(const WorkerOptions& o, const std::string& kernel,
                        std::vector<Lane> lanes) {
  std::vector<std::size_t> order(lanes.size());
  std::iota(order.begin(), order.end(), 0);
  // an order that never changed would favour somebody, in all processes alike
  std::minstd_rand random(static_cast<unsigned>(::getpid()));
  for (int round = 0; round < o.rounds; ++round) {
    std::shuffle(order.begin(), order.end(), random);
    for (const std::size_t i : order) {
      lanes[i].work->run(lanes[i].steps / 4);  // predictors and caches were another's until now
      lanes[i].times.push_back(seconds(*lanes[i].work, lanes[i].steps));
    }
  }
  const double steps = lanes[0].steps;
  WorkerResult r{.kernel = kernel};
  r.base_ns = 1e9 * median(lanes[0].times) / steps;
  r.head_ns = 1e9 * median(lanes[1].times) / steps;
  r.head = median_ratio(lanes[1], lanes[0]);
  r.aa = median_ratio(lanes[2], lanes[0]);
  for (std::size_t i = 3; i < lanes.size(); ++i) {
    // steps are whole: as if exactly so many more had been injected
    const double wanted = 1 + o.injected[i - 3], really = lanes[i].steps / steps;
    r.canaries.push_back(median_ratio(lanes[i], lanes[0]) * wanted / really);
  }
  return r;
}

}  // namespace

std::vector<WorkerResult> run_worker(const WorkerOptions& o) {
  return ask<std::vector<WorkerResult>>("worker", o);
}

std::map<std::string, std::vector<WorkerResult>> run_layout(const Layouts& layouts, int seed,
                                                            int processes, WorkerOptions o) {
  const TemporaryFolder folder;
  o.base = folder.path() + "/base.so";
  o.head = folder.path() + "/head.so";
  layouts.write(static_cast<std::uint64_t>(seed), o.base, o.head);
  std::map<std::string, std::vector<WorkerResult>> results;
  for (int i = 0; i < processes; ++i) {
    o.seed = static_cast<unsigned>(seed * processes + i + 1);
    for (WorkerResult& r : run_worker(o)) results[r.kernel].push_back(std::move(r));
  }
  return results;
}

int worker_main(const std::string& text) {
  const WorkerOptions o = nlohmann::json::parse(text);
  const TemporaryFolder folder;
  std::vector<Plugin> plugins;
  for (std::size_t i = 0; i < 3 + o.injected.size(); ++i) {
    plugins.emplace_back(folder.copy(i == 1 ? o.head : o.base, fmt::format("{}.so", i)));
  }
  Lives lives(o.seed, kLifeSamples);
  std::vector<WorkerResult> all;
  for (const std::string& kernel : o.kernels)
    all.push_back(run_rounds(o, kernel, lanes_of(o, plugins, lives, kernel)));
  std::cout << nlohmann::json(all).dump();
  return 0;
}

}  // namespace tauext::gate
