// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "bench/roster/robots.h"
#include "bench/seeds/golden.h"

namespace tauext::test {
namespace {

bool differ(std::optional<double> a, std::optional<double> b, double tolerance) {
  if (!a || !b || std::isnan(*a) || std::isnan(*b)) return a.has_value() != b.has_value();
  return std::abs(*a - *b) > tolerance * std::max(1., std::max(std::abs(*a), std::abs(*b)));
}

// whether a golden file would say so
bool differ(const Score& a, const Score& b, double times) {
  for (const MetricRow& m : kMetrics) {
    if (!m.is(MetricRow::kGate)) continue;
    if (differ(a.get(m.metric), b.get(m.metric), times * m.tolerance)) return true;
    if (!m.is(MetricRow::kGateJoints)) continue;
    const Score::Joints &of_a = a.joints(m.metric), &of_b = b.joints(m.metric);
    for (std::size_t j = 0; j < of_a.size(); ++j) {
      if (differ(of_a[j], of_b[j], times * m.tolerance)) return true;
    }
  }
  return false;
}

// whether nobody could say so: no estimate moves by 1e-6 of itself, and no score at all
bool equal(const Suite::Run& a, const Suite::Run& b) {
  const auto same = [](const Detection& x, const Detection& y) {
    return x.score == y.score && x.contact == y.contact;
  };
  return std::equal(a.detections.begin(), a.detections.end(), b.detections.begin(), same) &&
         (a.output.tau_ext - b.output.tau_ext).norm() <= 1e-6 * a.output.tau_ext.norm();
}

// Golden metrics of two entries, side by side; traces are recorded once.
class Rivals {
 public:
  explicit Rivals(const Sensors& sensors) : suite_(with(sensors)) {}

  bool metrics_differ(const Entry& a, const Entry& b) {
    Score& of_a = scores_[a.name()];
    if (of_a.empty()) of_a = suite_.score(a);
    return differ(of_a, suite_.score(b), a.scenario().has_obstacle() ? kOfContacts : 1);
  }
  bool equal(const Entry& a, const Entry& b) { return test::equal(suite_.run(a), suite_.run(b)); }

 private:
  static SuiteOptions with(const Sensors& sensors) {
    SuiteOptions o;
    o.sensors = sensors;
    return o;
  }

  Suite suite_;
  std::map<std::string, Score> scores_;
};

// Whether the golden metrics of some scenario say that an estimator or a detector, which stands
// behind the EKF, is another; true also where no estimate and no score tells them apart.
class Seen {
 public:
  bool estimator(const Robot& r, const std::string& a, const std::string& b) {
    std::vector<std::pair<Entry, Entry>> all;
    for (const Scenario& s : r.scenarios())
      all.push_back({{r.name(), s.name, a}, {r.name(), s.name, b}});
    return seen(all);
  }
  bool detector(const Robot& r, const std::string& a, const std::string& b) {
    std::vector<std::pair<Entry, Entry>> all;
    for (const Entry& e : entries({.estimators = {"ekf"}, .detectors = {a}})) {
      if (e.robot().name() != r.name() || e.detector().empty()) continue;
      all.push_back({e, {r.name(), e.scenario().name, "ekf", b}});
    }
    return seen(all);
  }

 private:
  bool seen(const std::vector<std::pair<Entry, Entry>>& all) {
    const auto any = [&](auto&& found) {
      return std::any_of(all.begin(), all.end(),
                         [&](const auto& ab) { return found(ab.first, ab.second); });
    };
    return any([&](const Entry& a, const Entry& b) {
             return good_.metrics_differ(a, b) || (poor(a) && poor_.metrics_differ(a, b));
           }) ||
           !any([&](const Entry& a, const Entry& b) {
             return !good_.equal(a, b) || (poor(a) && !poor_.equal(a, b));
           });
  }

  // those that are golden with poor sensors, too
  static bool poor(const Entry& e) {
    return e.scenario().name == "step" || e.scenario().name == "collision";
  }

  Rivals good_{golden_sensors()}, poor_{degraded_sensors()};
};

// each number of a field alone, larger by `share`: "1/2.02/3"
std::vector<std::string> perturbed(const FieldHelp& f, double share) {
  std::vector<std::string> values, all;
  std::istringstream in(f.value);
  for (std::string v; std::getline(in, v, '/');) values.push_back(v);
  for (std::string& v : values) {
    const std::string was = v;
    const double x = std::stod(was);
    if (x == 0) continue;
    v = fmt::format("{}", f.unit == "samples" ? x + 1 : x * (1 + share));
    all.push_back(fmt::format("{}={}", f.key, fmt::join(values, "/")));
    v = was;
  }
  return all;
}

// what is no number, and what acts on odd samples, at the start or after contacts alone
bool is_gain(const FieldHelp& f) {
  for (const char* key : {"max_gap", "gate", "P0", "Ts", "start_up", "refractory", "most_score"}) {
    if (f.key == key || f.key.ends_with(std::string(".") + key)) return false;
  }
  return !f.value.empty() && f.value.find_first_not_of("0123456789.e+-/") == std::string::npos;
}

// every specification of `plain` with one gain that is larger by `share`
std::vector<std::string> specifications(const std::string& plain,
                                        const std::vector<FieldHelp>& fields, double share) {
  std::vector<std::string> all;
  for (const FieldHelp& f : fields) {
    if (!is_gain(f)) continue;
    for (const std::string& key : perturbed(f, share)) all.push_back(plain + ":" + key);
  }
  return all;
}

TEST(BlindSpots, NoGainOfAnEstimatorMovesByAPercentUnseen) {
  Seen seen;
  for (const auto& r : robots()) {
    int gains = 0;
    for (const std::string& e : r->estimators()) {
      for (const std::string& other : specifications(e, r->estimator_fields(e), 0.01)) {
        EXPECT_TRUE(seen.estimator(*r, e, other)) << r->name() << " " << other;
        ++gains;
      }
    }
    EXPECT_GT(gains, 15 * r->dof());
  }
}

TEST(BlindSpots, NoThresholdOfADetectorMovesByThreePercentUnseen) {
  Seen seen;
  for (const auto& r : robots()) {
    int thresholds = 0;
    for (const std::string& d : r->detectors()) {
      for (const std::string& other : specifications(d, r->detector_fields(d), 0.03)) {
        EXPECT_TRUE(seen.detector(*r, d, other)) << r->name() << " " << other;
        ++thresholds;
      }
    }
    EXPECT_GT(thresholds, 8 * r->dof());
  }
}

}  // namespace
}  // namespace tauext::test
