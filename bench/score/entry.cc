// SPDX-License-Identifier: Apache-2.0
#include "bench/score/entry.h"

#include <fmt/format.h>

#include <algorithm>
#include <regex>
#include <stdexcept>
#include <utility>

#include "bench/roster/baselines.h"
#include "bench/roster/robots.h"
#include "mjcf/trace/known.h"

namespace tauext {
namespace {

// what is selected of the estimators or of the detectors
class Selected {
 public:
  enum class Kind { kEstimators, kDetectors };

  Selected(Kind kind, const std::vector<std::string>& specifications,
           const std::vector<const Robot*>& robots)
      : kind_(kind), specifications_(specifications) {
    refuse_twice(kind == Kind::kEstimators ? "estimator" : "detector", specifications_);
    for (const std::string& s : specifications_) require_on_some_robot(s, robots);
  }

  std::vector<std::string> of(const Robot& r) const {
    std::vector<std::string> all = specifications_.empty() ? names(r) : specifications_;
    std::erase_if(all, [&](const std::string& s) {
      return specifications_.empty() ? kind_ == Kind::kDetectors && study_only(s)
                                     : !error(r, s).empty();
    });
    return all;
  }

 private:
  std::vector<std::string> names(const Robot& r) const {
    return kind_ == Kind::kEstimators ? r.estimators() : r.detectors();
  }

  // why a robot cannot run it; "" if it can
  std::string error(const Robot& r, const std::string& specification) const {
    try {
      if (kind_ == Kind::kEstimators) {
        r.check(specification, "");
      } else {
        r.check(r.estimators().front(), specification);
      }
      return "";
    } catch (const std::invalid_argument& e) {
      return e.what();
    }
  }

  // the error of a robot that knows the name says more than that of one that does not
  void require_on_some_robot(const std::string& specification,
                             const std::vector<const Robot*>& robots) const {
    std::string unknown_name, wrong_keys;
    for (const Robot* r : robots) {
      const std::string e = error(*r, specification);
      if (e.empty()) return;
      const std::vector<std::string> known = names(*r);
      const bool named = std::count(known.begin(), known.end(),
                                    std::string(name_of_specification(specification))) > 0;
      std::string& first = named ? wrong_keys : unknown_name;
      if (first.empty()) first = e;
    }
    throw std::invalid_argument(wrong_keys.empty() ? unknown_name : wrong_keys);
  }

  Kind kind_;
  const std::vector<std::string>& specifications_;
};

}  // namespace

Entry::Entry(std::string_view robot, std::string_view scenario, std::string_view estimator,
             std::string_view detector)
    : robot_(&tauext::robot(robot)),
      scenario_(&scenario_of(*robot_, scenario)),
      estimator_(estimator),
      detector_(detector) {
  robot_->check(estimator_, detector_);
}

Entry Entry::made_elsewhere(const std::string& group, const std::string& estimator,
                            const std::string& detector, const Robot* robot) {
  Entry e;
  e.robot_ = robot;
  e.estimator_ = estimator;
  e.detector_ = detector;
  e.group_ = group;
  return e;
}

std::string Entry::group() const {
  return !group_.empty() ? group_ : robot_->label() + "/" + scenario_->name;
}

std::string Entry::name() const {
  return group() + "/" + estimator_ + (detector_.empty() ? "" : "+" + detector_);
}

Entry Entry::with_detector(const std::string& detector) const {
  Entry e = *this;
  e.detector_ = detector;
  return e;
}

std::vector<const Robot*> robots_of(const Selection& selection) {
  if (selection.robot != nullptr) return {selection.robot};
  std::vector<const Robot*> all;
  for (const auto& r : robots()) all.push_back(r.get());
  return all;
}

std::vector<Entry> entries(const Selection& selection) {
  const std::vector<const Robot*> robots = robots_of(selection);
  const Selected estimators(Selected::Kind::kEstimators, selection.estimators, robots);
  const Selected detectors(Selected::Kind::kDetectors, selection.detectors, robots);
  std::vector<Entry> all;
  for (const Robot* known : robots) {
    const Robot& r = *known;
    const std::vector<std::string> of_robot = estimators.of(r), behind = detectors.of(r);
    for (const Scenario& s : r.scenarios()) {
      for (const std::string& e : of_robot) all.push_back(Entry(r, s, e));
      if (s.response != Response::kDetection && s.response != Response::kLag) continue;
      for (const std::string& e : of_robot) {
        if (is_baseline(e)) continue;
        for (const std::string& d : behind) all.push_back(Entry(r, s, e).with_detector(d));
      }
    }
  }
  return all;
}

std::function<bool(const std::string&)> entry_filter(const std::string& expression) {
  try {
    return [wanted = std::regex(expression)](const std::string& name) {
      return std::regex_search(name, wanted);
    };
  } catch (const std::regex_error& e) {
    throw std::invalid_argument(
        fmt::format("'{}' is no regular expression: {}", expression, e.what()));
  }
}

void fail_no_match(const std::string& expression) {
  throw std::invalid_argument(
      fmt::format("the filter '{}' matches nothing; see --list", expression));
}

}  // namespace tauext
