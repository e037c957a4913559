// SPDX-License-Identifier: Apache-2.0
#include "bench/peers/peers.h"

#include <dlfcn.h>
#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <memory>
#include <stdexcept>
#include <utility>

#include "bench/peers/kdl_module.h"
#include "bench/roster/pair.h"
#include "bench/roster/robots.h"
#include "bench/score/detection_metrics.h"
#include "bench/score/metrics.h"
#include "bench/score/suite.h"
#include "estimators/ekf_parameters.h"
#include "mjcf/plant/tree.h"
#include "mjcf/record.h"

namespace tauext::peers {
namespace {

struct Entry {
  Peer peer;
  Runner runner;
  std::vector<double> rounds;  // [s]
};

// [N m] of the worst joint
double rmse(const Trace& trace, const Output& out, double from) {
  Score score;
  add_error_metrics(trace, out, from, score);
  return score.get(Metric::kRmse).value_or(kNoValue);
}

template <int N>
std::vector<Entry> entries_of(const std::string& module, const Robot& r, const Trace& trace,
                              const Model& model, double w) {
  std::vector<Entry> all;
  const std::string of_w = fmt::format(":bandwidth={}", w);
  for (const char* const name : {"ekf", "ndob_wb", "mo1"})
    all.push_back({{name, name}, {r.pair(name + of_w, "", trace), trace}, {}});
  const auto make = reinterpret_cast<MakeStage>(function_of(module, kMakeStage));
  const TreeModel<N> arm = tree_model<N>(model);
  for (int i = 0; i < N; ++i) {
    if (arm.parameters().joints[static_cast<std::size_t>(i)].parent != i - 1)
      throw std::invalid_argument(fmt::format("{} branches, and KDL takes chains", r.name()));
  }
  const auto ekf = EkfParameters<N>::for_bandwidth(arm, w);
  for (const auto& [name, beside] :
       {std::pair("kdl_ekf", "ekf"), std::pair("kdl_ndob", "ndob_wb"),
        std::pair("kdl_momentum", "mo1"), std::pair("kdl_wrench", "mo1")}) {
    std::unique_ptr<EstimatorStage<>> stage(
        static_cast<EstimatorStage<>*>(make(N, name, &arm.parameters(), &ekf, w)));
    all.push_back({{name, beside}, {Pair(std::move(stage), nullptr), trace}, {}});
  }
  return all;
}

// before a trace is made
void require_compiled(const Robot& r) {
  if (r.dof() != 3 && r.dof() != 6 && r.dof() != 7)
    throw std::invalid_argument(
        fmt::format("{} has {} joint{}; peers are compiled for 3, 6 and 7 (--lock keeps joints of "
                    "a file's robot still)",
                    r.name(), r.dof(), r.dof() == 1 ? "" : "s"));
}

std::vector<Entry> entries(const std::string& module, const Robot& r, const Trace& trace,
                           const Model& model, double w) {
  if (r.dof() == 3) return entries_of<3>(module, r, trace, model, w);
  if (r.dof() == 6) return entries_of<6>(module, r, trace, model, w);
  return entries_of<7>(module, r, trace, model, w);
}

}  // namespace

std::string module_path() {
  const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe");
  const std::filesystem::path beside = program.parent_path() / "tauext_kdl.so";
  return std::filesystem::exists(beside) ? beside
                                         : program.parent_path() / TAUEXT_MODULE_FROM_PROGRAM;
}

void* function_of(const std::string& module, const char* name) {
  // its own symbols come first, or KDL would be given our Eigen
  void* const opened = dlopen(module.c_str(), RTLD_NOW | RTLD_LOCAL | RTLD_DEEPBIND);
  void* const function = opened == nullptr ? nullptr : dlsym(opened, name);
  if (function != nullptr) return function;
  throw std::runtime_error(fmt::format("{}: {}", module, dlerror()));
}

std::vector<Peer> compare(const std::string& module, const Robot& r, const std::string& scenario,
                          double bandwidth, int rounds,
                          const std::function<void(double)>& progress) {
  require_compiled(r);
  const Scenario& s = scenario_of(r, scenario);
  const Model model = r.load_for(s);
  const Trace trace = record(model, s);
  std::vector<Entry> all = entries(module, r, trace, model, bandwidth);
  for (Entry& e : all) e.peer.rmse = rmse(trace, e.runner.run(), s.score_from);
  for (int i = 0; i < rounds; ++i) {
    if (progress) progress(1. * i / rounds);
    for (Entry& e : all) e.rounds.push_back(batch_seconds(e.runner));
  }
  std::vector<Peer> peers;
  for (Entry& e : all) {
    const auto ours = std::find_if(all.begin(), all.end(),
                                   [&](const Entry& o) { return o.peer.name == e.peer.beside; });
    std::vector<double> ratios;
    for (std::size_t i = 0; i < e.rounds.size(); ++i)
      ratios.push_back(e.rounds[i] / ours->rounds[i]);
    const double median = metrics::quantile(e.rounds, 0.5);
    e.peer.ns = median * 1e9 / Runner::kBatch;
    e.peer.spread =
        (metrics::quantile(e.rounds, 0.75) - metrics::quantile(e.rounds, 0.25)) / 2 / median;
    e.peer.ratio = metrics::quantile(ratios, 0.5);
    peers.push_back(e.peer);
  }
  return peers;
}

}  // namespace tauext::peers
