// SPDX-License-Identifier: Apache-2.0
#include "bench/roster/threshold_file.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <set>
#include <stdexcept>

#include "bench/roster/robots.h"
#include "mjcf/import/json_object.h"
#include "mjcf/trace/atomic_file.h"
#include "mjcf/trace/printable.h"

namespace tauext {
namespace {

using Json = JsonObject::Json;

// the second has sets for one condition of the study
constexpr const char *kFormat = "tauext-thresholds-1", *kOfConditions = "tauext-thresholds-2";

Json to_json(const Trained& t) {
  Json j;
  j["threshold"] = std::vector<double>(t.threshold.begin(), t.threshold.end());
  for (const auto& row : t.metric.rowwise()) {
    j["metric"].push_back(std::vector<double>(row.begin(), row.end()));
  }
  return j;
}

Eigen::VectorXd vector_of(const Json& j, int dof, const std::string& where) {
  const auto values = j.get<std::vector<double>>();
  if (static_cast<int>(values.size()) != dof) {
    throw std::runtime_error(
        fmt::format("{}: {} numbers for {} joints", where, values.size(), dof));
  }
  return Eigen::Map<const Eigen::VectorXd>(values.data(), dof);
}

Trained trained_of(const Json& j, int dof, const std::string& where) {
  Trained t{vector_of(j.at("threshold"), dof, where), {}};
  if (!(t.threshold.minCoeff() > 0)) {
    throw std::runtime_error(
        fmt::format("{}: a threshold of {} is not positive", where, t.threshold.minCoeff()));
  }
  if (!j.contains("metric")) return t;
  if (j["metric"].size() != static_cast<std::size_t>(dof)) {
    throw std::runtime_error(
        fmt::format("{}: the metric has {} rows for {} joints", where, j["metric"].size(), dof));
  }
  t.metric.resize(dof, dof);
  for (int i = 0; i < dof; ++i) t.metric.row(i) = vector_of(j["metric"][i], dof, where).transpose();
  return t;
}

ThresholdSet set_of(const Json& j) {
  ThresholdSet set;
  set.robot = j.at("robot").get<std::string>();
  set.velocity_noise = j.at("velocity_noise_rad_s").get<double>();
  set.fingerprint = j.value("arm", "");
  set.condition = j.value("condition", "");
  // an arm goes by its fingerprint: its file may have been elsewhere, and is not looked for
  const Robot* const known = set.fingerprint.empty() ? &robot(set.robot) : nullptr;
  int dof = known != nullptr ? known->dof() : 0;
  for (const auto& [estimator, detectors] : j.at("thresholds").items()) {
    for (const auto& [detector, values] : detectors.items()) {
      if (known != nullptr) known->check(estimator, detector);
      if (dof == 0) dof = static_cast<int>(values.at("threshold").size());
      set.by_estimator[estimator][detector] =
          trained_of(values, dof, fmt::format("{}/{}+{}", set.robot, estimator, detector));
    }
  }
  return set;
}

// of this robot as it is now; null if there is none
const ThresholdSet* set_for(const Thresholds& t, const Robot& r, double velocity_noise,
                            const std::string& condition) {
  if (const ThresholdSet* const set = t.of(r.name(), velocity_noise, r.fingerprint(), condition))
    return set;
  for (const ThresholdSet& s : t.sets) {
    if (s.robot != r.name() || s.fingerprint == r.fingerprint()) continue;
    throw std::runtime_error(
        fmt::format("{}: they are of another arm than {} is now; make them again with "
                    "tauext-detect --calibrate",
                    t.path, r.name()));
  }
  return nullptr;
}

// what a file has instead, as close to what was asked for as it has anything
std::string what_there_is(const Thresholds& t, const ThresholdSet* set, const Robot& robot,
                          const std::string& estimator) {
  std::set<std::string> names;
  if (set == nullptr) {
    const auto file = [](const std::string& path) {
      return std::filesystem::path(path).filename();
    };
    bool alike = false;  // by name, though not the same arm
    for (const ThresholdSet& s : t.sets) {
      names.insert(s.robot + (s.condition.empty() ? "" : " in " + s.condition));
      alike =
          alike || (s.fingerprint != robot.fingerprint() && file(s.robot) == file(robot.name()));
    }
    return fmt::format("it is for {}{}", fmt::join(names, ", "),
                       alike ? ", another arm whose file has that name" : "");
  }
  const auto behind = set->by_estimator.find(estimator);
  if (behind == set->by_estimator.end()) {
    for (const auto& [name, detectors] : set->by_estimator) names.insert(name);
    return fmt::format("there it has those behind {}", fmt::join(names, ", "));
  }
  for (const auto& [name, values] : behind->second) names.insert(name);
  return fmt::format("behind this estimator it has those of {}", fmt::join(names, ", "));
}

}  // namespace

std::string thresholds_json(const Thresholds& t, const Json& more) {
  Json j;
  const bool of_conditions = std::any_of(
      t.sets.begin(), t.sets.end(), [](const ThresholdSet& s) { return !s.condition.empty(); });
  j["format"] = of_conditions ? kOfConditions : kFormat;
  j["trained_on"] = t.trained_on;
  j["margin"] = t.margin;
  j["units"] = "each detector's statistic, see estimators/detectors/; one value per joint";
  j.update(more.is_null() ? Json::object() : more);
  j["sets"] = Json::array();
  for (const ThresholdSet& s : t.sets) {
    Json set;
    set["robot"] = s.robot;
    if (!s.fingerprint.empty()) set["arm"] = s.fingerprint;
    if (!s.condition.empty()) set["condition"] = s.condition;
    set["velocity_noise_rad_s"] = s.velocity_noise;
    for (const auto& [estimator, detectors] : s.by_estimator) {
      for (const auto& [detector, values] : detectors) {
        set["thresholds"][estimator][detector] = to_json(values);
      }
    }
    j["sets"].push_back(set);
  }
  return j.dump(2) + "\n";
}

void write_thresholds(const Thresholds& t, const std::string& path, const Json& more) {
  AtomicFile file(path);
  file.write(thresholds_json(t, more));
  file.commit();
}

Thresholds read_thresholds(const std::string& path) {
  Json j;
  try {
    j = read_json(path);
  } catch (const std::runtime_error& e) {
    throw std::runtime_error(
        fmt::format("{}; tauext-detect --calibrate writes files of thresholds", e.what()));
  }
  try {
    const Json format = j.is_object() ? j.value("format", Json()) : Json();
    if (format != kFormat && format != kOfConditions)
      throw std::runtime_error(
          fmt::format("\"format\" is {}, not \"{}\"; write it with tauext-detect --calibrate",
                      format.dump(), kFormat));
    Thresholds t{.path = path};
    t.trained_on = j.at("trained_on").get<std::string>();
    t.margin = j.at("margin").get<double>();
    if (!(t.margin > 0))
      throw std::runtime_error(fmt::format("a margin of {} is not positive", t.margin));
    if (j.at("sets").empty()) throw std::runtime_error("there is no set of thresholds in it");
    for (const Json& set : j.at("sets")) t.sets.push_back(set_of(set));
    return t;
  } catch (const Json::exception& e) {
    throw std::runtime_error(
        fmt::format("{}: no file of thresholds, as tauext-detect --calibrate writes it: {}", path,
                    one_line(e.what())));
  } catch (const std::exception& e) {
    throw std::runtime_error(fmt::format("{}: {}", path, one_line(e.what())));
  }
}

DetectorThresholds trained_for(const Thresholds& t, const Robot& r, double velocity_noise,
                               const std::string& estimator, const std::string& detector,
                               const std::string& condition) {
  if (t.sets.empty() || detector.empty()) return {};
  const std::vector<std::string> parts = r.trained_parts(detector);
  if (parts.empty()) return {};
  DetectorThresholds known;
  const ThresholdSet* const set = set_for(t, r, velocity_noise, condition);
  if (set != nullptr) {
    const auto behind = set->by_estimator.find(estimator);
    for (const std::string& part : parts) {
      if (behind == set->by_estimator.end()) break;
      const auto own = behind->second.find(part);
      if (own == behind->second.end()) continue;
      if (own->second.threshold.size() != r.dof())
        throw std::runtime_error(fmt::format("{}: {} numbers for {} joints", t.path,
                                             own->second.threshold.size(), r.dof()));
      known[std::string(name_of_specification(part))] = own->second;
    }
  }
  if (known.size() == parts.size()) return known;
  throw std::invalid_argument(fmt::format(
      "{}: has no thresholds for {}/{}+{}{}: {}; tauext-detect --calibrate makes more", t.path,
      r.name() + (condition.empty() ? "" : " in " + condition), estimator, detector,
      parts.front() == detector ? "" : fmt::format(" (of {})", fmt::join(parts, " and ")),
      what_there_is(t, set, r, estimator)));
}

}  // namespace tauext
