// SPDX-License-Identifier: Apache-2.0
// tauext-peers: our estimators beside what an engineer writes with Orocos KDL.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <optional>

#include "bench/peers/peers.h"
#include "bench/program/program.h"
#include "bench/roster/robots.h"
#include "bench/score/metric_list.h"
#include "mjcf/trace/atomic_file.h"
#include "mjcf/trace/table_writer.h"

namespace {

using namespace tauext;

void print(const std::vector<peers::Peer>& all, std::FILE* to) {
  TableWriter table({{"estimator", "", true},
                     {"step", "ns"},
                     {"+-", "%"},
                     {"times", ""},
                     {"of", "", true},
                     {"rmse", "N m"}});
  for (const peers::Peer& p : all) {
    table.add({p.name, fmt::format("{:.1f}", p.ns), fmt::format("{:.0f}", 100 * p.spread),
               fmt::format("{:.1f}", p.ratio), p.beside, fmt::format("{:.4g}", p.rmse)});
  }
  fmt::print(to, "{}", table.format());
}

void write(const std::vector<peers::Peer>& all, const std::string& robot,
           const std::string& scenario, double bandwidth, AtomicFile& file) {
  nlohmann::ordered_json j = {{"robot", robot},
                              {"scenario", scenario},
                              {"designed_for_rad_s", bandwidth},
                              {"level", level()}};
  for (const peers::Peer& p : all) {
    j["peers"].push_back({{"name", p.name},
                          {"beside", p.beside},
                          {"step_ns", p.ns},
                          {"spread", p.spread},
                          {"ratio", p.ratio},
                          {key_of(Metric::kRmse), p.rmse}});
  }
  file.write(j.dump(2) + "\n");
  file.commit();
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "Times and scores our estimators and what an engineer writes with Orocos KDL: the "
      "textbook's\n"
      "EKF with Jacobians by differences, NDOB and momentum observer, and KDL's own. One process, "
      "one\n"
      "trace, all at one bandwidth, in turn. times: of ours of the same kind, the median over "
      "rounds.\n\n"
      "  tauext-peers --robot wallmobot3",
      "tauext-peers");
  std::string name = "wallmobot3", lock, scenario = "sine", out;
  double bandwidth = 30;
  int rounds = 201;
  add_robot_flags(app, name, lock);
  app.add_option("--scenario", scenario, "of the robot")->capture_default_str()->type_name("NAME");
  app.add_option("--bandwidth", bandwidth, "of all [rad/s]")
      ->capture_default_str()
      ->check(CLI::Range(1., 200.))
      ->type_name("W");
  app.add_option("--rounds", rounds, "of 1000 steps each")
      ->capture_default_str()
      ->check(CLI::Range(3, 100000))
      ->type_name("N");
  app.add_option("--out", out, "JSON to write; - for standard output")
      ->type_name("FILE")
      ->check(not_empty);
  return run_program(app, argc, argv, [&] {
    std::optional<AtomicFile> file;  // made before the work
    if (!out.empty()) file.emplace(out);
    Progress progress("timing");
    const std::vector<peers::Peer> all = peers::compare(
        peers::module_path(), robot(name, lock), scenario, bandwidth, rounds, progress.callback());
    progress.clear();
    print(all, out == "-" ? stderr : stdout);
    if (file) write(all, name, scenario, bandwidth, *file);
    return kGood;
  });
}
