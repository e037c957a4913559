// SPDX-License-Identifier: Apache-2.0
#include "regression/history/history.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <limits>
#include <nlohmann/json.hpp>
#include <numeric>
#include <stdexcept>

#include "mjcf/trace/input_file.h"
#include "mjcf/trace/printable.h"
#include "regression/accuracy/accuracy_layer.h"
#include "regression/counts/instructions.h"
#include "regression/host/child.h"
#include "regression/time/time_layer.h"

namespace tauext::gate {
namespace {

using nlohmann::ordered_json;

constexpr int kVersion = 1;

ordered_json json_of(const KernelRecord& k) {
  ordered_json j = {{"ratio", k.ratio}, {"low", k.low}, {"high", k.high}, {"surely", k.surely}};
  if (k.ns) j["ns"] = *k.ns;
  j["instructions"] = k.instructions;
  j["instructions_ratio"] = k.instructions_ratio;
  return j;
}

// a time that is no number, or not above 0, would be believed by everything behind it
double positive(const ordered_json& j, const char* key) {
  const double x = j.at(key).get<double>();
  if (!(x > 0)) throw std::runtime_error(fmt::format("{} is {}, and must be above 0", key, x));
  return x;
}

KernelRecord kernel_of(const ordered_json& j) {
  KernelRecord k{.ratio = positive(j, "ratio"),
                 .low = positive(j, "low"),
                 .high = positive(j, "high"),
                 .surely = j.at("surely"),
                 .ns = {},
                 .instructions = j.at("instructions"),
                 .instructions_ratio = positive(j, "instructions_ratio")};
  if (j.contains("ns")) k.ns = positive(j, "ns");
  if (!(k.low <= k.ratio && k.ratio <= k.high) || k.instructions < 0) {
    throw std::runtime_error(fmt::format("a ratio {} from {} to {} with {} instructions a step",
                                         k.ratio, k.low, k.high, k.instructions));
  }
  return k;
}

Record record_of(const ordered_json& j) {
  if (const int version = j.at("version"); version != kVersion) {
    throw std::runtime_error(
        fmt::format("of version {}, and this program reads {}", version, kVersion));
  }
  Record r{.commit = j.at("commit"),
           .date = j.at("date"),
           .title = j.at("title"),
           .reference = j.at("reference"),
           .machine = j.at("machine"),
           .kernels = {},
           .metrics = {},
           .gone = {},
           .accepted = {}};
  check_record(r);
  for (const char* key : {"kernels", "metrics"}) {
    if (!j.at(key).is_object()) throw std::runtime_error(fmt::format("{} is no object", key));
  }
  for (const auto& [name, kernel] : j.at("kernels").items()) r.kernels[name] = kernel_of(kernel);
  for (const auto& [name, value] : j.at("metrics").items()) {
    r.metrics[name] =
        value.is_null() ? std::numeric_limits<double>::quiet_NaN() : value.get<double>();
  }
  j.at("gone").get_to(r.gone);
  for (const auto& a : j.at("accepted")) {
    r.accepted.push_back(
        {a.at("layer"), a.at("subject"), a.at("at_most"), a.at("base"), a.at("reason")});
    check_acceptance(r.accepted.back(), "accepted");
  }
  return r;
}

void refuse_what_is_no_record(const Record& r, const std::vector<Record>& history) {
  const std::pair<const char*, const std::string&> names[] = {
      {"--commit", r.commit}, {"--date", r.date}, {"--reference", r.reference}};
  for (const auto& [flag, value] : names) {
    if (value.empty()) throw std::invalid_argument(fmt::format("{} is empty", flag));
  }
  for (const Record& known : history) {
    if (known.commit == r.commit) {
      throw std::invalid_argument(fmt::format("--commit {}: is on record already", r.commit));
    }
  }
}

std::map<std::string, KernelRecord> kernels_of(const MeasureOptions& o, std::string& machine) {
  if (o.progress) o.progress("counting instructions");
  const Counts base = count_instructions(o.base, o.kernels);
  const Counts head = count_instructions(o.head, o.kernels);
  const TimeReport times = compare_times({.base = o.base,
                                          .head = o.head,
                                          .kernels = o.kernels,
                                          .counted_otherwise = counted_otherwise(base, head),
                                          .progress = o.progress});
  machine = fmt::format("{}, {}", processor(), head.key.at("compiler"));
  std::map<std::string, KernelRecord> kernels;
  for (const KernelTime& k : times.kernels) {
    KernelRecord& r = kernels[k.kernel];
    const double after = static_cast<double>(head.kernels.at(k.kernel));
    r.instructions = after / kCountedSteps;
    r.instructions_ratio = after / static_cast<double>(base.kernels.at(k.kernel));
    const TimeVerdict& v = k.verdict;
    if (v.harness_error) throw std::runtime_error(fmt::format("{}: {}", k.kernel, v.why));
    if (v.verdict == Verdict::kIdentical) continue;
    r.ratio = v.ratio;
    r.low = v.low;
    r.high = v.high;
    r.surely = v.verdict == Verdict::kInconclusive ? 0 : v.surely;
    r.ns = k.head_ns;
  }
  return kernels;
}

// over the seeds that have a value; NaN where most have none
double mean_of_most(std::vector<double> values) {
  const std::size_t all = values.size();
  std::erase_if(values, [](double v) { return std::isnan(v); });
  if (2 * values.size() <= all) return kNever;
  return std::accumulate(values.begin(), values.end(), 0.) / static_cast<double>(values.size());
}

// what is not as it was
void compare_metrics(const MeasureOptions& o, const std::vector<Record>& history, Record& r) {
  if (o.bench.empty()) return;
  if (o.progress) o.progress("scoring every entry");
  const Golden golden = parse_golden(run_bench(o.bench, o.entries), "what " + o.bench + " wrote");
  std::map<std::string, double> before = metrics_after(history, history.size());
  for (const auto& [key, line] : golden.lines) {
    const std::string name = key.first + " " + key.second;
    const double mean = mean_of_most(line.values);
    const auto it = before.find(name);
    const bool same =
        it != before.end() && (it->second == mean || (std::isnan(it->second) && std::isnan(mean)));
    if (!same) r.metrics[name] = mean;
    before.erase(name);
  }
  for (const auto& [name, value] : before) r.gone.push_back(name);
}

}  // namespace

void check_record(const Record& r) {
  const auto plain = [](const std::string& text) {
    return !text.empty() && std::all_of(text.begin(), text.end(), [](unsigned char c) {
      return std::isalnum(c) || std::strchr("-_.:+", c) != nullptr;
    });
  };
  for (const auto& [what, text] : {std::pair("commit", r.commit), {"date", r.date}}) {
    if (plain(text)) continue;
    throw std::runtime_error(
        fmt::format("the {} is '{}', and must be one word", what, printable(text)));
  }
}

std::string format_record(const Record& r) {
  ordered_json j = {{"version", kVersion}, {"commit", r.commit},       {"date", r.date},
                    {"title", r.title},    {"reference", r.reference}, {"machine", r.machine}};
  j["kernels"] = ordered_json::object();
  for (const auto& [name, kernel] : r.kernels) j["kernels"][name] = json_of(kernel);
  j["metrics"] = ordered_json::object();
  for (const auto& [name, value] : r.metrics) {
    j["metrics"][name] = std::isnan(value) ? ordered_json() : ordered_json(value);
  }
  j["gone"] = r.gone;
  j["accepted"] = ordered_json::array();
  for (const Acceptance& a : r.accepted) {
    j["accepted"].push_back({{"layer", a.layer},
                             {"subject", a.subject},
                             {"at_most", a.at_most},
                             {"base", a.base},
                             {"reason", a.reason}});
  }
  // a title of other than UTF-8 is no reason to lose a record
  return j.dump(-1, ' ', false, ordered_json::error_handler_t::replace);
}

std::vector<Record> parse_history(const std::string& text, const std::string& path) {
  std::vector<Record> history;
  std::size_t begin = 0;
  for (int number = 1; begin < text.size(); ++number) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    try {
      history.push_back(record_of(ordered_json::parse(text.substr(begin, end - begin))));
      const std::string& commit = history.back().commit;
      if (std::count_if(history.begin(), history.end(),
                        [&](const Record& r) { return r.commit == commit; }) > 1) {
        throw std::runtime_error(commit + " is on record twice");
      }
    } catch (const ordered_json::exception& e) {
      throw std::runtime_error(
          fmt::format("{}: line {}: no record of a commit: {}", path, number, e.what()));
    } catch (const std::runtime_error& e) {
      throw std::runtime_error(fmt::format("{}: line {}: {}", path, number, e.what()));
    }
    begin = end + 1;
  }
  return history;
}

std::vector<Record> read_history(const std::string& path) {
  if (!std::filesystem::exists(path)) return {};
  return parse_history(read_json_text(path), path);
}

std::map<std::string, double> metrics_after(const std::vector<Record>& history,
                                            std::size_t records) {
  std::map<std::string, double> all;
  for (std::size_t i = 0; i < records; ++i) {
    for (const auto& [name, value] : history[i].metrics) all[name] = value;
    for (const std::string& name : history[i].gone) all.erase(name);
  }
  return all;
}

Record measure(const MeasureOptions& o, const std::vector<Record>& history) {
  refuse_what_is_no_record(o.record, history);
  Record r = o.record;
  r.kernels = kernels_of(o, r.machine);
  compare_metrics(o, history, r);
  r.accepted = read_acceptances(accepted_path(o.baselines));
  return r;
}

}  // namespace tauext::gate
