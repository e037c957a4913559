// SPDX-License-Identifier: Apache-2.0
#include "bench/run/suite_outputs.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <memory>
#include <stdexcept>
#include <vector>

#include "bench/live/entry_tap.h"
#include "bench/program/program.h"
#include "bench/report/page.h"
#include "bench/report/traces.h"
#include "bench/study/table3.h"
#include "mjcf/trace/atomic_file.h"
#include "mjcf/trace/printable.h"

namespace tauext {
namespace {

using Rows = std::vector<Row>;
using Forces = std::map<std::string, std::unique_ptr<const ArmForces>>;  // by robot

// of all that are selected
Forces forces_of(const std::string& wrench, const Rows& rows) {
  Forces all;
  for (const Row& row : rows) {
    const Robot& r = row.entry.robot();
    auto& of_robot = all[r.name()];
    if (wrench.empty() || of_robot) continue;
    try {
      of_robot = r.forces_at(wrench, r.dof() >= kJointsOfMoment);
    } catch (const std::invalid_argument& e) {
      throw std::invalid_argument(
          fmt::format("--wrench: {}: {} (--robot selects one)", r.name(), e.what()));
    }
  }
  return all;
}

void print_table3(const SuiteResults& results) {
  const bool step = std::any_of(results.rows.begin(), results.rows.end(), [](const Row& r) {
    return r.entry.group() == "wallmobot3/step";  // what Table III is about
  });
  if (step) fmt::print(results.words, "\n{}", study::format_table3());
}

void write_report(const SuiteOutputs& outputs, const SuiteResults& results, const Forces& forces) {
  Progress progress("drawing");
  report::Traces traces(outputs.wrench);
  const Rows& rows = results.rows;
  for (const Row& row : rows) {
    if (row.score.error.empty())
      traces.add(row.entry, results.suite.run(row.entry),
                 forces.at(row.entry.robot().name()).get());
    progress.show(static_cast<double>(&row - rows.data()) / static_cast<double>(rows.size()));
  }
  AtomicFile file(*outputs.report);
  file.write(report::page_of({checked_result(report::kOwnResults, results.json),
                              checked_result(report::kOwnTraces, traces.json(results.line))}));
  file.commit();
  progress.clear();
  fmt::print(results.words, "\n{}: the report; open it in a browser\n", *outputs.report);
}

}  // namespace

int run_suite_with_outputs(const SuiteRun& run, const SuiteOutputs& outputs) {
  bool ran = false;
  Forces forces;
  std::optional<EntryTap> tap;
  SuiteHooks hooks;
  hooks.begin = [&](const Rows& rows) {
    if (outputs.report) AtomicFile{*outputs.report};  // an unwritable path should not cost a run
    forces = forces_of(outputs.wrench, rows);
    tap.emplace(outputs.lcm, outputs.lcm_log.value_or(""));
  };
  if (outputs.lcm_log)
    hooks.scored = [&](const Row& row, const Suite::Run& of) {
      tap->log(row.entry, of, row.score);
    };
  hooks.through = [&](const Row& row) { tap->publish(row.entry, row.score); };
  hooks.printed = [&](const SuiteResults& results) {
    ran = true;
    if (outputs.paper) print_table3(results);
  };
  if (outputs.report)
    hooks.written = [&](const SuiteResults& results) { write_report(outputs, results, forces); };
  const int code = run_suite(run, hooks);
  if (!ran || tap->heard()) return code;
  say("no summary could be published");
  return kAnswerIsNo;
}

}  // namespace tauext
