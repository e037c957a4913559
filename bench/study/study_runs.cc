// SPDX-License-Identifier: Apache-2.0
#include "bench/study/study_runs.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <utility>

#include "bench/roster/baselines.h"
#include "bench/roster/robots.h"
#include "bench/roster/roster.h"
#include "mjcf/plant/model_error.h"
#include "mjcf/record_plain.h"
#include "mjcf/scenarios/generic.h"
#include "mjcf/trace/known.h"

namespace tauext::study {
namespace {

Degradation noisy(double velocity_noise) {
  return {.sensors = {.velocity_noise = velocity_noise}};
}

// the quick ones are the conditions so far
void add_honest(StudyRuns& r) {
  for (const Condition& c : r.conditions) r.quick.push_back(c.name);
  for (const int every : {1, 4}) {
    const char *of_name = every == 1 ? "" : "_250hz", *at = every == 1 ? "" : "; at 250 Hz";
    for (const auto& [name, description, faults] : named_degradations()) {
      if (every == 1) r.honest.push_back(name);
      if (every == 1 || faults.drives.elastic())
        r.conditions.push_back(
            {name + of_name, description + at, 0, 0, faults, Motions::kBrisk, every, true});
    }
  }
}

Scenario moved(Scenario s, Motions motions, const Eigen::VectorXd& home,
               const Eigen::VectorXd& reach, std::uint64_t seed) {
  if (motions == Motions::kSlow) return s;
  s.reference = brisk_motion(home, reach, seed, seed >= kTrainingSeed);
  s.start_on_reference = true;
  return s;
}

Degradation hysteresis() {  // of 3000 N m
  return {.sensors = {.velocity_noise = 1e-4, .loadcell = {.hysteresis = 0.002}}};
}

Degradation dry_friction() {  // 5 N m
  return {.sensors = {.velocity_noise = 1e-4}, .model_error = {.friction = 5}};
}

StudyRuns runs_of_wallmobot3() {
  StudyRuns r{.robot = &robot("wallmobot3"), .carries = 150};
  r.conditions = {
      {"known_0", "no panel, and the estimators know", 0, 0, noisy(1e-4)},
      {"known_50", "a panel of 50 kg, known", 50, 50, noisy(1e-4)},
      {"known_150", "a panel of 150 kg, known", 150, 150, noisy(1e-4)},
      {"unknown_50", "50 kg, and the estimators believe in none", 50, 0, noisy(1e-4)},
      {"unknown_150", "150 kg, and the estimators believe in none", 150, 0, noisy(1e-4)},
      {"noise_known_0", "no panel, known; velocity noise 1e-3 rad/s", 0, 0, noisy(1e-3)},
      {"noise_known_150", "150 kg, known; velocity noise 1e-3 rad/s", 150, 150, noisy(1e-3)},
      {"noise_unknown_150", "150 kg, unknown; velocity noise 1e-3 rad/s", 150, 0, noisy(1e-3)},
      {"hysteresis", "150 kg, known; torque sensors with 6 N m of hysteresis", 150, 150,
       hysteresis()},
      {"dry_friction", "150 kg, known; 5 N m of dry friction that the estimators do not know", 150,
       150, dry_friction()},
  };
  // the paper's range, 0 to 150 kg, known and unknown
  r.training = {"known_0", "known_50", "known_150", "unknown_50", "unknown_150"};
  r.model = [](const PlantKey& p) { return with_errors(wallmobot3_with_panel(p.panel), p.error); };
  r.believer = wallmobot3_believing;
  r.touched = [](TouchKind kind, std::uint64_t seed, Motions m) {
    const Eigen::Vector3d home = Eigen::Vector3d::Zero(), reach = home.array() + 0.5;
    return moved(touched_wallmobot3(kind, seed), m, home, reach, seed);
  };
  r.touches = touches_of_wallmobot3;
  r.points = []() -> const TouchPoints& {
    static const TouchPoints all(wallmobot3_with_panel(0), Eigen::VectorXd::Zero(3));
    return all;
  };
  add_honest(r);
  return r;
}

// of any arm
StudyRuns runs_of_any(const Robot& r) {
  StudyRuns runs{.robot = &r};
  Degradation heavy = noisy(1e-4), rubbing = noisy(1e-4);
  heavy.model_error.mass = 1.05;
  rubbing.model_error = r.hidden_friction();
  runs.conditions = {
      {"known", "the estimators know the arm", 0, 0, noisy(1e-4)},
      {"noise", "known; velocity noise 1e-3 rad/s", 0, 0, noisy(1e-3)},
      {"heavy", "the last link weighs 5 % more than the estimators know", 0, 0, heavy},
      {"dry_friction", r.hidden_friction_in_words() + " that the estimators do not know", 0, 0,
       rubbing},
  };
  runs.training = {"known", "heavy"};
  const ArmScale scale = scale_of(r.load_for(quiet()));
  if (!(scale.force > 0))
    throw std::invalid_argument(
        fmt::format("{}: no force on its end effector moves it: nothing to detect", r.name()));
  runs.model = [&r](const PlantKey& p) { return r.load_for(quiet(), p.error); };
  runs.believer = [&r](double) { return std::shared_ptr<const Robot>(&r, [](const Robot*) {}); };
  runs.touched = [scale](TouchKind kind, std::uint64_t seed, Motions m) {
    return moved(touched_arm(scale, kind, seed), m, scale.home, scale.reach, seed);
  };
  runs.touches = [scale](TouchKind kind, std::uint64_t seed) {
    return touches_of(scale, kind, seed);
  };
  struct Made {
    std::once_flag once;
    std::optional<TouchPoints> points;
  };
  runs.points = [&r, home = scale.home, made = std::make_shared<Made>()]() -> const TouchPoints& {
    std::call_once(made->once, [&] { made->points.emplace(r.load_for(quiet()), home); });
    return *made->points;
  };
  add_honest(runs);
  return runs;
}

// made when it is first asked for
const StudyRuns& of_any(const Robot& r) {
  static std::mutex mutex;
  static std::map<const Robot*, StudyRuns> all;
  const std::lock_guard alone(mutex);
  const auto found = all.find(&r);
  return found != all.end() ? found->second : all.emplace(&r, runs_of_any(r)).first->second;
}

// what has the name of a known one; its keys are checked by building it
template <class Build>
std::vector<std::string> chosen(const char* what, const std::vector<std::string>& asked,
                                const std::vector<std::string>& known, Build&& build) {
  refuse_twice(what, asked);
  for (const std::string& specification : asked) {
    const std::string name(name_of_specification(specification));
    if (std::count(known.begin(), known.end(), name) == 0) throw unknown(what, name, known);
    build(specification);
  }
  return asked.empty() ? known : asked;
}

std::vector<std::string> competitors(const Robot& r) {
  std::vector<std::string> names = r.estimators();
  std::erase_if(names, [](const std::string& n) { return is_baseline(n); });
  return names;
}

std::uint64_t sensors_seed(const Job& job) {
  if (job.region >= 0) return static_cast<std::uint64_t>(job.region + 1) * 100'000'000 + job.seed;
  return 4 * job.seed + static_cast<std::uint64_t>(job.kind);
}

Scenario scenario_of(const StudyRuns& runs, const Job& job) {
  Scenario s = runs.touched(job.kind, job.seed, job.plant.motions);
  if (job.region < 0) return s;
  s.force = quiet().force;
  s.contact = quiet().contact;
  s.regions = meetings_of(runs, job);
  return s;
}

}  // namespace

PlantKey plant_of(const Condition& c) {
  return {c.panel, c.degradation.model_error, c.degradation.drives, c.motions};
}

const StudyRuns& touched_runs(const Robot* r) {
  static const StudyRuns first = runs_of_wallmobot3();
  if (r == nullptr || r == first.robot) return first;
  if (r->name() != "testbed1") return of_any(*r);
  throw std::invalid_argument(
      fmt::format("the detection study has no runs for {}; it has them for {}, {}, and for robots "
                  "from files",
                  r->name(), first.robot->name(), fmt::join(kRobotsByMjcf, ", ")));
}

const Condition& condition(const StudyRuns& runs, const std::string& name) {
  return find_known(runs.conditions, "condition", name, [](const auto& c) { return c.name; });
}

std::vector<RegionTouch> meetings_of(const StudyRuns& runs, const Job& job) {
  return runs.points().draw(static_cast<std::size_t>(job.region), job.seed, kScoreFrom,
                            quiet().duration);
}

std::vector<Trace> simulated(const StudyRuns& runs, std::span<const Job> jobs, const Model& model) {
  std::vector<Scenario> scenarios;
  for (const Job& job : jobs) scenarios.push_back(scenario_of(runs, job));
  return runs.robot->simulate(model, scenarios, {.drives = jobs.front().plant.drives});
}

void require_mujoco_agrees(const StudyRuns& runs, const Job& job, const Model& model,
                           const Trace& truth) {
  const Trace by_mujoco = simulate(model, scenario_of(runs, job), {.drives = job.plant.drives});
  const double off = difference(by_mujoco, truth);
  if (off < 1e-9) return;
  throw std::runtime_error(
      fmt::format("{}: the run of seed {} differs by {:.2g} from MuJoCo's, and 1e-9 is allowed",
                  runs.robot->name(), job.seed, off));
}

Trace thinned(const Trace& trace, int n) {
  if (n == 1) return trace;
  std::vector<int> kept;
  for (int k = 0; k < trace.size(); k += n) kept.push_back(k);
  Trace thin = select_samples(trace, kept);
  thin.torque_at_instants = true;
  return thin;
}

Trace measured(const Trace& truth, Sensors sensors, const Job& job) {
  sensors.seed = sensors_seed(job);
  return measure(truth, sensors);
}

Views::Views(std::vector<Trace> truths, std::span<const Job> jobs) {
  for (std::size_t i = 0; i < jobs.size(); ++i) {
    Trace& t = truths[i];
    seeds_.push_back(sensors_seed(jobs[i]));
    drawn_.push_back(velocity_noise(t.dof(), seeds_.back()));
    forces_.push_back(std::move(t.contact_force));
    readings_.push_back({.t = std::move(t.t),
                         .q = t.encoder_q(),
                         .qd = t.encoder_qd(),
                         .tau = std::move(t.tau),
                         .torque_at_instants = t.torque_at_instants,
                         .screws = std::move(t.screws),
                         .usual_torque = std::move(t.usual_torque)});
  }
}

std::vector<Trace> Views::by(const Sensors& sensors, int every) {
  std::vector<Trace> seen;
  Sensors mine = sensors;
  for (std::size_t i = 0; i < readings_.size(); ++i) {
    mine.seed = seeds_[i];
    seen.push_back(thinned(measure(readings_[i], mine, drawn_[i]), every));
  }
  return seen;
}

std::vector<std::string> chosen_conditions(const StudyRuns& runs,
                                           const std::vector<std::string>& asked,
                                           const std::vector<std::string>& otherwise) {
  refuse_twice("condition", asked);
  for (const std::string& name : asked) condition(runs, name);
  return asked.empty() ? otherwise : asked;
}

std::vector<std::string> chosen_estimators(const Robot& r, const std::vector<std::string>& asked) {
  return chosen("estimator", asked, competitors(r), [&](const std::string& e) { r.check(e, ""); });
}

std::vector<std::string> chosen_detectors(const Robot& r, const std::vector<std::string>& asked) {
  const std::string any = competitors(r).front();
  return chosen("detector", asked, r.detectors(), [&](const std::string& d) { r.check(any, d); });
}

}  // namespace tauext::study
