// SPDX-License-Identifier: Apache-2.0
#include "bench/study/detection/tuned.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <tuple>

#include "bench/roster/threshold_file.h"
#include "mjcf/import/json_object.h"
#include "mjcf/trace/printable.h"

namespace tauext::study {
namespace {

using Json = nlohmann::ordered_json;

Json to_json(const TunedRow& p) {
  Json j = {{"robot", p.robot}};
  if (!p.arm.empty()) j["arm"] = p.arm;
  j["condition"] = p.condition;
  j["estimator"] = p.estimator;
  j["detector"] = p.detector;
  j["recall"] = p.recall;
  j["before"] = p.before;
  j["recall_before"] = std::isnan(p.recall_before) ? Json() : Json(p.recall_before);
  j["evaluations"] = p.evaluations;
  if (!p.at_ends.empty()) j["at_ends_of_ranges"] = p.at_ends;
  return j;
}

TunedRow row_of(const Json& j) {
  TunedRow p;
  p.robot = j.at("robot").get<std::string>();
  p.arm = j.value("arm", "");
  p.condition = j.at("condition").get<std::string>();
  p.estimator = j.at("estimator").get<std::string>();
  p.detector = j.at("detector").get<std::string>();
  p.recall = j.at("recall").get<double>();
  p.before = j.at("before").get<std::string>();
  const auto& before = j.at("recall_before");
  p.recall_before =
      before.is_null() ? std::numeric_limits<double>::quiet_NaN() : before.get<double>();
  p.evaluations = j.at("evaluations").get<int>();
  p.at_ends = j.value("at_ends_of_ranges", std::vector<std::string>());
  return p;
}

}  // namespace

bool is_tuned(const TunedRow& row, const Robot& robot, const std::string& condition) {
  return row.condition == condition && row.arm == robot.fingerprint() &&
         (!row.arm.empty() || row.robot == robot.name());
}

void append(const TunedStudy& more, TunedStudy& to) {
  Thresholds& t = to.thresholds;
  const auto join = [](const std::string& text, std::string& all) {
    if (!text.empty() && ("; " + all + "; ").find("; " + text + "; ") == all.npos)
      all += (all.empty() ? "" : "; ") + text;
  };
  if (!t.sets.empty() && t.margin != more.thresholds.margin)
    throw std::invalid_argument(
        fmt::format("{}: its margin is {}, and that of what is added {}: use another file", t.path,
                    t.margin, more.thresholds.margin));
  t.margin = more.thresholds.margin;
  join(more.thresholds.trained_on, t.trained_on);
  join(more.made_by, to.made_by);
  for (const ThresholdSet& s : more.thresholds.sets) {
    const auto same = std::find_if(t.sets.begin(), t.sets.end(), [&](const ThresholdSet& k) {
      return k.robot == s.robot && k.fingerprint == s.fingerprint && k.condition == s.condition &&
             k.velocity_noise == s.velocity_noise;
    });
    if (same == t.sets.end()) {
      t.sets.push_back(s);
      continue;
    }
    for (const auto& [estimator, detectors] : s.by_estimator) {
      for (const auto& [detector, trained] : detectors)
        same->by_estimator[estimator][detector] = trained;
    }
  }
  to.rows.insert(to.rows.end(), more.rows.begin(), more.rows.end());
  // whoever came first: a file that was made in parts is the one that was made at once
  const auto key = [](const TunedRow& p) {
    return std::tie(p.robot, p.arm, p.condition, p.before, p.estimator, p.detector);
  };
  std::sort(to.rows.begin(), to.rows.end(),
            [&](const TunedRow& a, const TunedRow& b) { return key(a) < key(b); });
  std::sort(t.sets.begin(), t.sets.end(), [](const ThresholdSet& a, const ThresholdSet& b) {
    return std::tie(a.robot, a.fingerprint, a.condition, a.velocity_noise) <
           std::tie(b.robot, b.fingerprint, b.condition, b.velocity_noise);
  });
}

void write_tuned(const TunedStudy& tuned, const std::string& path) {
  Json more = {{"made_by", tuned.made_by}, {"tuned", Json::array()}};
  for (const TunedRow& p : tuned.rows) more["tuned"].push_back(to_json(p));
  write_thresholds(tuned.thresholds, path, more);
}

TunedStudy read_tuned(const std::string& path) {
  TunedStudy tuned{read_thresholds(path), {}, ""};
  try {
    const auto j = read_json(path);
    tuned.made_by = j.value("made_by", "");
    for (const auto& p : j.value("tuned", Json::array())) tuned.rows.push_back(row_of(p));
  } catch (const Json::exception& e) {
    throw std::runtime_error(
        fmt::format("{}: \"tuned\" is no list of pairs as tauext-tune writes it: {}", path,
                    one_line(e.what())));
  }
  return tuned;
}

}  // namespace tauext::study
