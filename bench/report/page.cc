// SPDX-License-Identifier: Apache-2.0
#include "bench/report/page.h"

#include <fmt/format.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string_view>

#include "bench/report/assets.h"
#include "bench/score/metric_list.h"
#include "mjcf/import/json_object.h"
#include "mjcf/trace/input_file.h"
#include "mjcf/trace/printable.h"

namespace tauext::report {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::string_view kBegin = R"(<script type="application/json" id="results">)";

// JSON that ends no script: it has < in texts alone
std::string embedded(std::string json) {
  for (std::size_t at = 0; (at = json.find('<', at)) != json.npos; at += 6)
    json.replace(at, 1, "\\u003c");
  return json;
}

// the list of metrics, for who draws them
std::string metrics_json() {
  Json all = Json::array();
  for (const MetricRow& m : kMetrics) {
    all.push_back({{"key", m.key},
                   {"title", m.title},
                   {"unit", m.unit},
                   {"digits", m.digits},
                   {"better", m.better == Better::kLess   ? -1
                              : m.better == Better::kMore ? 1
                                                          : 0},
                   {"joints", m.joints != WorstJoint::kNone},
                   {"never_is_best", m.is(MetricRow::kNeverIsBest)},
                   {"table", m.is(MetricRow::kTable)},
                   {"star", m.is(MetricRow::kStar)},
                   {"meaning", m.meaning}});
  }
  return all.dump();
}

}  // namespace

std::string page_of(const std::vector<ResultFile>& results) {
  std::string all;
  for (const ResultFile& r : results) {
    all += fmt::format("{}{{\"name\":{},\"kind\":{},\"data\":{}}}", all.empty() ? "" : ",",
                       Json(r.name).dump(), Json(r.kind).dump(), r.json);
  }
  std::map<std::string, std::string> parts = assets();
  parts["RESULTS"] = embedded("[" + all + "]");
  parts["METRICS"] = embedded(metrics_json());
  const std::string& form = assets().at("report.html");
  std::string page;
  for (std::size_t at = 0; at < form.size();) {  // @NAME@ stands for a part
    const std::size_t from = form.find("@[", at), to = form.find("]@", at);
    page += form.substr(at, from - at);
    if (from == form.npos) break;
    page += parts.at(form.substr(from + 2, to - from - 2));
    at = to + 2;
  }
  return page;
}

std::vector<ResultFile> read_results(const std::string& path) {
  const std::string text = read_json_text(path);
  if (!path.ends_with(".html")) return {checked_result(path, text)};
  const std::size_t begin = text.find(kBegin);
  if (begin == text.npos)
    throw std::runtime_error(path + ": no report of tauext-report, which would hold its results");
  const std::size_t end = text.find("</script>", begin);
  if (end == text.npos || text.find("</html>", end) == text.npos)
    throw std::runtime_error(path + ": a report whose end is missing; write or copy it again");
  std::vector<ResultFile> results;
  try {
    for (const Json& r :
         parse_json(text.substr(begin + kBegin.size(), end - begin - kBegin.size()))) {
      results.push_back(checked_result(r.at("name"), r.at("data").dump()));
      std::string& name = results.back().name;
      if (name == kOwnResults || name == kOwnTraces)
        name = std::filesystem::path(path).stem().string() + ".json";
    }
  } catch (const std::exception& e) {
    throw std::runtime_error(fmt::format("{}: what it holds: {}", path, one_line(e.what())));
  }
  return results;
}

void require_page(const std::string& path, const std::string& flag) {
  if (!path.ends_with(".html"))
    throw std::invalid_argument(fmt::format("{} {}: a page is FILE.html", flag, path));
}

}  // namespace tauext::report
