// SPDX-License-Identifier: Apache-2.0
#include "regression/remember.h"

#include <fmt/format.h>

#include <stdexcept>

#include "bench/program/program.h"
#include "mjcf/trace/atomic_file.h"
#include "mjcf/trace/input_file.h"
#include "mjcf/trace/printable.h"
#include "regression/history/drift.h"

namespace tauext::gate {

void add_history(CLI::App& app, HistoryFlags& f) {
  CLI::App* sub = app.add_subcommand("append", "measure a commit and add it to a history");
  const auto add = [&](const char* name, std::string& to, const char* help, const char* type) {
    return sub->add_option(name, to, help)->type_name(type);
  };
  Record& r = f.measure.record;
  add("history", f.file, "JSON, a line for each commit", "FILE")->required();
  add("--commit", r.commit, "that is measured", "SHA")->required();
  add("--date", r.date, "of that commit", "ISO-DATE")->required();
  add("--title", r.title, "of that commit", "TEXT");
  add("--reference", r.reference, "the commit that it is measured beside, as the last release",
      "SHA")
      ->required();
  add("--base", f.measure.base, "plug-in of the reference", "SO")->required();
  add("--head", f.measure.head, "plug-in of the commit", "SO");
  add("--bench", f.measure.bench, "program with --golden; \"\": no metrics", "PROGRAM");
  add("--kernels", f.measure.kernels, "those that match alone", "REGEX")->check(regular_expression);
  add("--entries", f.measure.entries, "those that match alone", "REGEX")->check(regular_expression);
  add("--baselines", f.measure.baselines, "folder with what the commit accepts", "FOLDER")
      ->capture_default_str();

  sub = app.add_subcommand("history", "what has added up in a history since the last release");
  add("history", f.file, "as append writes it", "FILE")->required();
  sub->add_flag("--all", f.all, "show kernels that never changed, too");
  add("--markdown", f.markdown, "the same for a page", "FILE");
  add("--charts", f.charts, "its last commit for github-action-benchmark", "FILE.json");
}

ExitCode append(const HistoryFlags& f) {
  check_record(f.measure.record);
  if (f.measure.bench.empty()) say("no --bench: no metrics are recorded");
  const std::vector<Record> history = read_history(f.file);
  std::string text = history.empty() ? "" : read_whole(f.file);
  if (!text.empty() && text.back() != '\n') text += '\n';
  release_input(f.file);  // it is made of what it was
  AtomicFile file(f.file);
  const Record record = measure(f.measure, history);
  file.write(text + format_record(record) + "\n");
  file.commit();
  fmt::print("{}: commits on record: {}, the last is {}\n", f.file, history.size() + 1,
             printable_name(record.commit));
  return kGood;
}

ExitCode show_history(const HistoryFlags& f) {
  const std::vector<Record> history = parse_history(read_json_text(f.file), f.file);
  if (history.empty()) throw std::runtime_error(f.file + ": no commit is on record");
  const Drift drift = drift_of(history);
  fmt::print("{}", printable(format_drift(history, drift, f.all, false)));
  if (!f.markdown.empty()) {
    AtomicFile file(f.markdown);
    file.write(printable(format_drift(history, drift, f.all, true)));
    file.commit();
  }
  if (!f.charts.empty()) {
    AtomicFile file(f.charts);
    file.write(format_for_charts(history.back()));
    file.commit();
  }
  if (!drift.any()) return kGood;
  return drift.slower() ? kSlower : kLessAccurate;
}

}  // namespace tauext::gate
