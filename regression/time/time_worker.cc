// SPDX-License-Identifier: Apache-2.0
#include "regression/time/time_worker.h"

#include <benchmark/benchmark.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
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
namespace {

using nlohmann::json;

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
  std::vector<double> cold;   // [s] of a step after other work
};

std::vector<Lane> lanes_of(const WorkerOptions& o, const std::vector<Plugin>& plugins, Lives& lives,
                           const std::string& kernel) {
  std::vector<Lane> lanes;
  for (const Plugin& plugin : plugins) {
    const int i = plugin.find(kernel);
    if (i < 0) throw std::runtime_error(kernel + ": not in both plug-ins");
    lanes.push_back({std::make_unique<Work>(plugin, i, lives.of(plugin, i)), 0, {}, {}});
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

constexpr std::size_t kMemory = std::size_t{2} << 20, kLine = 64;  // [bytes]
constexpr int kBranches = 128, kFunctions = 64;

volatile std::uint64_t sink;

// a branch each at an address of its own, taken or not
template <int I>
[[gnu::always_inline]] inline void branch(std::uint64_t random) {
  if (random >> (I % 64) & 1) sink = I;
}

template <int F, int... I>
[[gnu::noinline]] void branches(std::uint64_t random, std::integer_sequence<int, I...>) {
  (branch<F * kBranches + I>(random * (2 * I + 1)), ...);
}

template <int... F>
void all_branches(std::uint64_t& random, std::integer_sequence<int, F...>) {
  ((random = random * 6364136223846793005u + 1442695040888963407u,
    branches<F>(random, std::make_integer_sequence<int, kBranches>())),
   ...);
}

// reads and writes 2 MB, and takes 8192 branches at random [about 0.2 ms], after which caches and
// predictors know nothing of a kernel
void do_other_work() {
  static std::vector<unsigned char> memory(kMemory);
  static std::uint64_t random = 1;
  for (std::size_t i = 0; i < kMemory; i += kLine) ++memory[i];
  all_branches(random, std::make_integer_sequence<int, kFunctions>());
}

// head, base and base's copy, a step each with other work before it
void run_cold(benchmark::State& state, int steps, std::minstd_rand& random,
              std::vector<Lane>& lanes) {
  std::array<std::size_t, 3> order{0, 1, 2};
  for (int k = 0; k < steps; ++k) {
    std::shuffle(order.begin(), order.end(), random);  // the first one fetches the sample
    for (const std::size_t i : order) {
      do_other_work();
      lanes[i].cold.push_back(seconds(*lanes[i].work, 1));
    }
  }
  const double base = steps > 0 ? median(lanes[0].cold) : 0;
  state.counters["cold_head"] = steps > 0 ? median(lanes[1].cold) / base : 1;
  state.counters["cold_aa"] = steps > 0 ? median(lanes[2].cold) / base : 1;
}

void run_rounds(benchmark::State& state, const WorkerOptions& o, std::vector<Lane>& lanes) {
  std::vector<std::size_t> order(lanes.size());
  std::iota(order.begin(), order.end(), 0);
  // an order that never changed would favour somebody, in all processes alike
  std::minstd_rand random(static_cast<unsigned>(::getpid()));
  for (auto _ : state) {
    std::shuffle(order.begin(), order.end(), random);
    for (const std::size_t i : order) {
      lanes[i].work->run(lanes[i].steps / 4);  // predictors and caches were another's until now
      lanes[i].times.push_back(seconds(*lanes[i].work, lanes[i].steps));
    }
    state.SetIterationTime(lanes[1].times.back());
  }
  run_cold(state, o.cold_steps, random, lanes);
  const double steps = lanes[0].steps;
  auto& found = state.counters;
  found["base_ns"] = 1e9 * median(lanes[0].times) / steps;
  found["head_ns"] = 1e9 * median(lanes[1].times) / steps;
  found["head"] = median_ratio(lanes[1], lanes[0]);
  found["aa"] = median_ratio(lanes[2], lanes[0]);
  for (std::size_t i = 3; i < lanes.size(); ++i) {
    // steps are whole: as if exactly so many more had been injected
    const double wanted = 1 + o.injected[i - 3], really = lanes[i].steps / steps;
    found[fmt::format("canary{}", i - 3)] = median_ratio(lanes[i], lanes[0]) * wanted / really;
  }
}

}  // namespace

std::vector<WorkerResult> run_worker(const WorkerOptions& o) {
  const json options = {{"base", o.base},         {"head", o.head},
                        {"kernels", o.kernels},   {"seed", o.seed},
                        {"rounds", o.rounds},     {"block", o.block},
                        {"injected", o.injected}, {"cold_steps", o.cold_steps}};
  const std::string out = run_child({this_program(), "worker", options.dump()});
  std::vector<WorkerResult> results;
  try {
    const json document = json::parse(out);
    for (const json& b : document.at("benchmarks")) {
      // its name ends in what Google Benchmark thinks of it: /iterations:20/manual_time
      WorkerResult r{.kernel = b.value("label", b.at("name").get<std::string>())};
      if (b.value("error_occurred", false)) {
        throw std::runtime_error(r.kernel + ": " + b.value("error_message", "?"));
      }
      r.base_ns = b.at("base_ns");
      r.head_ns = b.at("head_ns");
      r.head = b.at("head");
      r.aa = b.at("aa");
      r.cold_head = b.at("cold_head");
      r.cold_aa = b.at("cold_aa");
      for (std::size_t i = 0; i < o.injected.size(); ++i) {
        r.canaries.push_back(b.at(fmt::format("canary{}", i)));
      }
      results.push_back(std::move(r));
    }
  } catch (const json::exception& e) {
    throw std::runtime_error(fmt::format("a timing process said something else: {}", e.what()));
  }
  if (results.size() != o.kernels.size()) {
    throw std::runtime_error(
        fmt::format("a timing process ran {} kernels of {}", results.size(), o.kernels.size()));
  }
  return results;
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
    o.cold_steps = 0;  // once is enough
  }
  return results;
}

int worker_main(const std::string& text) {
  const json j = json::parse(text);
  WorkerOptions o;
  j.at("base").get_to(o.base);
  j.at("head").get_to(o.head);
  j.at("kernels").get_to(o.kernels);
  j.at("seed").get_to(o.seed);
  j.at("rounds").get_to(o.rounds);
  j.at("block").get_to(o.block);
  j.at("cold_steps").get_to(o.cold_steps);
  j.at("injected").get_to(o.injected);
  const TemporaryFolder folder;
  std::vector<Plugin> plugins;
  for (std::size_t i = 0; i < 3 + o.injected.size(); ++i) {
    plugins.emplace_back(folder.copy(i == 1 ? o.head : o.base, fmt::format("{}.so", i)));
  }
  Lives lives(o.seed, kLifeSamples);
  for (const std::string& kernel : o.kernels) {
    benchmark::RegisterBenchmark(kernel.c_str(),
                                 [&, kernel](benchmark::State& state) {
                                   std::vector<Lane> lanes = lanes_of(o, plugins, lives, kernel);
                                   run_rounds(state, o, lanes);
                                   state.SetLabel(kernel);
                                 })
        ->UseManualTime()
        ->Iterations(o.rounds);
  }
  benchmark::JSONReporter reporter;
  reporter.SetOutputStream(&std::cout);
  reporter.SetErrorStream(&std::cerr);
  benchmark::RunSpecifiedBenchmarks(&reporter);
  return 0;
}

}  // namespace tauext::gate
