// SPDX-License-Identifier: Apache-2.0
#include "bench/report/result_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>
#include <stdexcept>
#include <valijson/adapters/nlohmann_json_adapter.hpp>
#include <valijson/schema.hpp>
#include <valijson/schema_parser.hpp>
#include <valijson/validation_results.hpp>
#include <valijson/validator.hpp>

#include "bench/report/assets.h"
#include "bench/score/metric_list.h"
#include "mjcf/import/json_object.h"
#include "mjcf/trace/printable.h"

namespace tauext {
namespace {

using Json = nlohmann::json;

// the kind of a file that has this format; "" has benchmarks instead
std::string kind_of(const Json& j, const Json& kinds, const std::string& name) {
  const Json format = j.is_object() ? j.value("format", Json()) : Json();
  std::string known;
  for (const auto& [kind, schema] : kinds.items()) {
    const Json& properties = schema["properties"];
    const bool ours = properties.contains("format");
    if (ours ? format == properties["format"]["const"] : j.contains("benchmarks")) return kind;
    if (ours) known += (known.empty() ? "" : ", ") + properties["format"]["const"].dump();
  }
  throw std::runtime_error(fmt::format(
      "{}: no file of results: {}, and must be one of {}; or it has \"benchmarks\", as "
      "tauext-bench --benchmark_out writes it",
      name, format.is_null() ? "\"format\" is not there" : "\"format\" is " + format.dump(),
      known));
}

// the first thing that is wrong, by its JSON pointer, like /benchmarks/2/rmse_Nm
void validate(const Json& j, const Json& of_kind, const std::string& name) {
  valijson::Schema schema;
  valijson::SchemaParser().populateSchema(valijson::adapters::NlohmannJsonAdapter(of_kind), schema);
  valijson::ValidationResults results;
  const valijson::adapters::NlohmannJsonAdapter target(j);
  if (valijson::Validator().validate(schema, target, &results)) return;
  std::string where, why;
  for (const valijson::ValidationResults::Error& e : results) {  // the deepest one says most
    std::string here;                                     // of "<root>", "[benchmarks]", "[2]"
    for (std::size_t i = 1; i < e.context.size(); ++i) {  // [key], or ["key"] since valijson 1.1
      const std::size_t quote = e.context[i].starts_with("[\"") ? 1 : 0;
      here.append("/").append(e.context[i], 1 + quote, e.context[i].size() - 2 - 2 * quote);
    }
    if (why.empty() || here.size() > where.size()) where = here, why = e.description;
  }
  std::string value = j.at(Json::json_pointer(where)).dump();
  if (value.size() > 60) value = value.substr(0, 57) + "...";
  throw std::runtime_error(
      fmt::format("{}: {} is {}: {}; tauext-report --schema says what it must be", name,
                  where.empty() ? "all of it" : where, value, one_line(why)));
}

// what the schema can't say of traces: each signal has as many values as there are times
void require_whole_traces(const Json& j, const std::string& name) {
  for (const Json& group : j["groups"]) {
    const std::size_t wanted = (2 * group["t"].size() + 2) / 3 * 4;  // 16 bit each, as base64
    for (const Json& series : group["series"]) {
      for (const char* rows : {"joints", "wrench"}) {
        const std::size_t first = group["series"][0].value(rows, Json::array()).size();
        const Json signals = series.value(rows, Json::array());
        const auto whole = [&](const Json& s) {
          return s["values"].get_ref<const std::string&>().size() == wanted;
        };
        if (signals.size() != first || !std::all_of(signals.begin(), signals.end(), whole))
          throw std::runtime_error(fmt::format(
              "{}: \"{}\" of {} in {} are not {} signals of {} values, as the times and the first "
              "series have them",
              name, rows, series["name"].dump(), group["name"].dump(), first, group["t"].size()));
      }
    }
  }
}

// of a history, which is a line for each commit
nlohmann::ordered_json object_of_lines(const std::string& text) {
  auto rows = nlohmann::ordered_json::array();
  std::istringstream in(text);
  int number = 0;
  for (std::string line; std::getline(in, line);) {
    ++number;
    if (line.find_first_not_of(" \t\r") == line.npos) continue;
    try {
      rows.push_back(parse_json(line));
    } catch (const std::exception& e) {
      constexpr std::string_view kOfOne = "at line 1, ";
      std::string why = e.what();
      if (const auto at = why.find(kOfOne); at != why.npos) why.erase(at, kOfOne.size());
      throw std::runtime_error(fmt::format("line {}: {}", number, why));
    }
  }
  return {{"format", "tauext-history-1"},
          {"context", nlohmann::ordered_json::object()},
          {"rows", rows}};
}

}  // namespace

std::string results_schema() {
  auto schema = nlohmann::ordered_json::parse(report::assets().at("results.schema.json"));
  auto& row = schema["definitions"]["suite"]["properties"]["benchmarks"]["items"];
  for (const MetricRow& m : kMetrics) {
    nlohmann::ordered_json type = {{"type", "number"}};
    const bool size = m.unit == "N m" || m.unit == "N" || m.unit == "ns";  // times may be negative
    if (size && m.better == Better::kLess) type["minimum"] = 0;
    if (m.joints != WorstJoint::kNone)
      row["patternProperties"][fmt::format("^{}_joint[1-9]$", m.key)] = type;
    type["description"] = m.meaning;
    row["properties"][std::string(m.key)] = type;
  }
  return schema.dump(1) + "\n";
}

ResultFile checked_result(const std::string& path, const std::string& text) {
  static const Json kinds = Json::parse(results_schema())["definitions"];
  std::string smallest;
  try {
    smallest = path.ends_with(".jsonl") ? object_of_lines(text).dump() : parse_json(text).dump();
  } catch (const std::exception& e) {
    throw std::runtime_error(fmt::format("{}: {}", path, one_line(e.what())));
  }
  const Json j = Json::parse(smallest);
  const std::string kind = kind_of(j, kinds, path);
  validate(j, kinds[kind], path);
  if (kind == "traces") require_whole_traces(j, path);
  return {std::filesystem::path(path).filename(), kind, smallest};
}

}  // namespace tauext
