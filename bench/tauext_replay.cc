// SPDX-License-Identifier: Apache-2.0
// tauext-replay: runs estimators over a recorded log.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include "bench/logs/lcm_trace.h"
#include "bench/logs/read_log.h"
#include "bench/logs/torque_sampling.h"
#include "bench/program/program.h"
#include "bench/replay/estimates_writer.h"
#include "bench/replay/replayed.h"
#include "bench/replay/torque_fit.h"
#include "bench/roster/baselines.h"
#include "bench/roster/robots.h"
#include "bench/roster/threshold_file.h"
#include "mjcf/plant/any_tree.h"
#include "mjcf/plant/coordinates.h"
#include "mjcf/trace/known.h"
#include "mjcf/trace/printable.h"

namespace {

using namespace tauext;

constexpr double kUsualGap = 0.05;  // [s] max_gap of estimators

// what the unit of t seems to be, if arms are sampled at 50 Hz to 10 kHz
std::string looks_like(double step) {
  if (step >= 0.1 && step <= 20) return ", so t looks like milliseconds";
  if (step >= 100 && step <= 20000) return ", so t looks like microseconds";
  if (step >= 1e5 && step <= 2e7) return ", so t looks like nanoseconds";
  return "";
}

// statuses that an engineer has to know of; false if most samples could not be used, with those
// that the reader has skipped
bool report_status(const Replayed& c, const LogReader& log) {
  const StatusCounts& counts = c.counts();
  const std::int64_t skipped = log.skipped();
  if (!counts.text().empty())
    say(fmt::format("{}: of {} samples {}", c.estimator(), counts.samples(), counts.sentence()));
  if (2 * (counts.left_out() + skipped) <= counts.samples() + skipped) return true;
  if (2 * counts.left_out() <= counts.samples()) {
    say(
        fmt::format("{}: most rows could not be used: {} were skipped (see above), {} of the other "
                    "{} left out",
                    c.estimator(), skipped, counts.left_out(), counts.samples()));
    return false;
  }
  if (2 * counts.of(Status::kFrozen) > counts.samples()) {
    say(
        fmt::format("{}: most readings repeat the one before, so these are no estimates. Is the "
                    "log faster than its sensors?",
                    c.estimator()));
    return false;
  }
  const double step = log.regularity().step;
  if (2 * counts.of(Status::kBadTime) > counts.samples() && step >= kUsualGap / 2 && step < 1) {
    say(fmt::format(
        "{0}: most samples were taken for the first after a gap, so these are no estimates. They "
        "are {1:.3g} s apart, and {0} goes on over `max_gap` at most, {2:g} s unless it is said: "
        "{3}:max_gap={4:.2g}",
        c.estimator(), step, kUsualGap, name_of_specification(c.estimator()), 8 * step));
    return false;
  }
  say(
      fmt::format("{}: most samples could not be used, so these are no estimates. Samples are "
                  "{:.3g} s apart{}. "
                  "Is q in rad, qd in rad/s, tau in N m?",
                  c.estimator(), step, looks_like(step)));
  return false;
}

// looks whether tau is what the estimators take it for
class TorqueCheck {
 public:
  // @param by_flag whether --torque has put their `torque` into them
  TorqueCheck(const Robot& r, const RecordingContents& log,
              const std::vector<std::string>& estimators, bool by_flag)
      : estimates_(2, Eigen::VectorXd::Zero(log.dof)),
        least_(Eigen::VectorXd::Constant(log.dof, std::numeric_limits<double>::infinity())),
        most_(-least_),
        weigher_(log.dof) {
    for (const std::string& e : estimators) {
      const auto fields = r.estimator_fields(name_of_specification(e));
      if (std::none_of(fields.begin(), fields.end(),
                       [](const FieldHelp& h) { return h.key == "torque"; }))
        continue;
      const std::string by_log = log.torque_at_instants ? "instant" : "held";
      const auto own = key_of(e, "torque");
      const bool instant = own.value_or(by_log) == "instant";
      takers_[instant].push_back(with_torque(e, instant ? "held" : "instant"));
      flag_will_do_[instant] = flag_will_do_[instant] && (by_flag || !own);
    }
    if (takers_[0].empty() && takers_[1].empty()) return;
    for (const char* torque : {"held", "instant"})
      observers_.push_back(
          r.pair(fmt::format("mo2:bandwidth={}:torque={}", kBandwidth, torque), "", Trace()));
  }

  void take(const RecordedSample& y) {
    if (observers_.empty()) return;
    bool ok = !y.contact;
    for (std::size_t i = 0; i < observers_.size(); ++i) {
      const StepResult s =
          observers_[i].step(y.t, y.q.data(), y.qd.data(), y.tau.data(), estimates_[i].data());
      ok = ok && s.status == Status::kOk;
    }
    if (!ok) return;
    weigher_.take(estimates_[0].data(), estimates_[1].data());
    least_ = least_.cwiseMin(y.tau), most_ = most_.cwiseMax(y.tau);
  }

  // false if estimates are off by that, as they would not be by the other reading
  bool report(const Regularity& log) const {
    const double samples = static_cast<double>(std::max<std::int64_t>(log.samples - 1, 1));
    const auto w = weigher_.weight(kBandwidth, (log.to - log.from) / samples);
    bool good = true;
    for (const bool instant : {false, true}) {
      if (!w || takers_[instant].empty() || !w->leans_from(instant)) continue;
      const auto& [now, other] =
          instant ? std::tie(w->instant, w->held) : std::tie(w->held, w->instant);
      // half as large again, and by more than matters
      const Eigen::ArrayXd much = 1.5 * other.array().sqrt() + 8e-4 * (most_ - least_).array();
      const bool costly = (now.array().sqrt() > much).any();
      if (!costly && !w->contradicts(instant)) continue;
      good = good && !costly;
      constexpr const char* kHow[] = {"held from each t", "read at each t"};
      say(fmt::format(
          "tau seems to be {} (weight {:.2f} +- {:.2f} of 0 held, 1 instant), and is taken as {}; "
          "use {}",
          kHow[!instant], w->weight, w->sure, kHow[instant], remedy(instant)));
    }
    return good;
  }

 private:
  static constexpr double kBandwidth = 30;  // [rad/s]

  static std::string with_torque(std::string estimator, const char* torque) {
    constexpr std::string_view kKey = ":torque=";
    if (const std::size_t at = estimator.find(kKey); at != estimator.npos)
      estimator.erase(at, estimator.find(':', at + 1) - at);
    return estimator + std::string(kKey) + torque;
  }

  // of those that take tau so
  std::string remedy(bool instant) const {
    if (flag_will_do_[instant]) return instant ? "--torque held" : "--torque instant";
    return fmt::format("--estimator {}", fmt::join(takers_[instant], ","));
  }

  // of tau as held, and as read at instants: who takes it so, as it would have to be written to
  // take it the other way; and whether --torque says that of all of them
  std::array<std::vector<std::string>, 2> takers_;
  std::array<bool, 2> flag_will_do_{true, true};
  std::vector<Pair> observers_;
  std::vector<Eigen::VectorXd> estimates_;
  Eigen::VectorXd least_, most_;  // [N m] of tau
  TorqueWeigher weigher_;
};

struct Flags {
  std::string log, channel, columns, contacts, robot, lock, detector, thresholds, torque, wrench,
      out;
  std::vector<std::string> estimators;
  double score_from = -std::numeric_limits<double>::infinity();
  bool list = false;
};

void add_flags(CLI::App& app, Flags& f) {
  app.add_option("log", f.log, "log to read: CSV, .npy, .npz, MCAP, a ROS 2 bag or LCM");
  app.add_option("--channel", f.channel, "of an LCM log, or topic of a bag, with several of them");
  app.add_option("--columns", f.columns,
                 "what the log's columns mean: a map, or libfranka, ur_rtde, ..")
      ->type_name("PRESET|FILE.toml");
  app.add_option("--contacts", f.contacts, "labels beside the log: file,start,end[,kind] [s]")
      ->type_name("FILE.csv")
      ->check(not_empty);
  add_robot_flags(app, f.robot, f.lock);
  app.add_option("--estimator", f.estimators, "NAME[:KEY=VALUE].., one or more apart by commas")
      ->delimiter(',')
      ->allow_extra_args(false);
  app.add_option("--detector", f.detector, "NAME[:KEY=VALUE].. behind each estimator");
  app.add_option("--thresholds", f.thresholds, "of the detector: file of tauext-detect --calibrate")
      ->type_name("FILE");
  app.add_option("--torque", f.torque,
                 "when tau acted: held from t on, or at t; else as the log says")
      ->type_name("held|instant")
      ->check(CLI::IsMember({"held", "instant"}));
  app.add_option("--wrench", f.wrench,
                 "the force at this site or body (end_effector), and the link touched")
      ->type_name("SITE")
      ->check(not_empty);
  app.add_option("--out", f.out, "CSV to write, .npz or .mcap; - is standard output");
  app.add_option("--score_from", f.score_from,
                 "errors count from this time on [s]; else from the begin")
      ->type_name("S");
  app.add_flag("--list", f.list, "list robots, estimators and detectors, and stop");
}

// checks them, too, and puts --torque into them
std::vector<DetectorSettings> settings_of(Flags& f, const Robot& r) {
  if (!f.thresholds.empty() && f.detector.empty())
    throw std::invalid_argument("--thresholds needs a --detector");
  const Thresholds trained = f.thresholds.empty() ? Thresholds() : read_thresholds(f.thresholds);
  std::vector<DetectorSettings> settings;  // of each estimator
  for (std::string& e : f.estimators) {
    r.check(e, f.detector);
    settings.push_back({trained_for(trained, r, 0, e, f.detector)});
    if (f.torque.empty()) continue;
    if (key_of(e, "torque")) {
      throw std::invalid_argument(fmt::format("--torque {}: {} says it, too", f.torque, e));
    }
    e = with_key(e, "torque", f.torque, r.estimator_fields(name_of_specification(e)));
  }
  return settings;
}

void refuse_incomplete(const Flags& f) {
  if (f.log.empty() || f.robot.empty() || f.estimators.empty() || f.out.empty())
    throw std::invalid_argument(
        "a log, --robot, --estimator and --out are required; see tauext-replay --help");
  if (is_lcm_log(f.out) || f.out.ends_with(".npy") || f.out.ends_with(".db3"))
    throw std::invalid_argument(
        fmt::format("--out {}: estimates are written as CSV, or to an .npz or an .mcap", f.out));
  refuse_twice("estimator", f.estimators);
}

int replay(Flags& f) {
  refuse_incomplete(f);
  const Robot& r = robot(f.robot, f.lock);
  const std::vector<DetectorSettings> settings = settings_of(f, r);
  const auto forces =
      f.wrench.empty() ? nullptr : r.forces_at(f.wrench, r.dof() >= kJointsOfMoment);
  const LogOptions options{f.channel, f.columns, r.joints(), true,
                           contacts_of(f.contacts, {f.log})};
  LogReader log(f.log, options);
  const RecordingContents& contents = log.contents();
  const RecordingContents recorded = contents;
  r.require_joints(contents.dof, f.log);
  if (r.is_from_file()) log.scale_torques(torque_gains_of(r.model()));
  log.use_gains(r.gains());
  std::optional<TorqueFit> fit;
  if (r.is_from_file())
    fit.emplace(tree_of(r.model()), contents.torque_at_instants, contents.without_gravity);
  if (contents.without_gravity) log.use_gravity(gravity_of(tree_of(r.model())));

  Trace truth;  // truth and delayed_truth copy it; nothing else needs the log in memory
  if (contents.has_truth && std::any_of(f.estimators.begin(), f.estimators.end(), needs_truth)) {
    LogReader again(f.log, options);
    truth = trace_of(again);
  }
  truth.torque_at_instants = contents.torque_at_instants;  // which estimators are told
  std::vector<Replayed> all;
  for (std::size_t i = 0; i < f.estimators.size(); ++i) {
    const std::string& e = f.estimators[i];
    all.emplace_back(Replayed::Setup{e, f.detector, forces.get(), f.score_from},
                     r.pair(e, f.detector, truth, settings[i]), contents);
  }
  truth = Trace();
  TorqueCheck torque(r, contents, f.estimators, !f.torque.empty());
  const auto out = estimates_writer(f.out, all, recorded);
  for (RecordedSample sample; log.next(sample);) {
    for (Replayed& c : all) c.take(sample);
    torque.take(sample);
    if (fit) fit->take(sample, sample.contact, sample.tau_ext);
    out->add(sample, log.recorded_tau(), all);
  }

  log.report();
  const Regularity& samples = log.regularity();
  r.require_range(log.least(), log.most(), f.log);
  if (!(f.score_from <= samples.to))
    throw std::invalid_argument(
        fmt::format("--score_from {}: the log ends at {} s", f.score_from, samples.to));
  bool good = log.usable() && (!fit || fits(*fit, f.log));
  for (const Replayed& c : all) good = report_status(c, log) && good;
  good = torque.report(samples) && good;
  out->commit();
  std::FILE* const to = f.out == "-" ? stderr : stdout;
  if (!contents.has_truth)
    fmt::print(to, "{} samples; no errors, as the log has no tau_ext\n", samples.samples);
  if (good) print_metrics(all, contents, to);
  if (good) print_forces(all, contents.dof, to);
  return good ? kGood : kAnswerIsNo;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "Runs estimators over a log (LCM, or CSV with the columns of tauext-record, of which tau_ext "
      "and\n"
      "contact may be missing), writes a row per usable sample, and prints the errors. Exit code "
      "1:\n"
      "unusable. Status: 0 ok, 1 started, 2 bad sample, 3 singular inertia, 4 diverged, 5 bad "
      "time, 6\n"
      "beyond a limit, 7 jump, 8 frozen, 9 unlikely; all but 0 hold the old estimate.\n\n"
      "  tauext-replay log.csv --robot wallmobot3 --estimator ekf,ndob --out est.csv\n",
      "tauext-replay");
  Flags flags;
  add_flags(app, flags);
  return run_program(app, argc, argv, [&]() -> int {
    if (!flags.list) return replay(flags);
    fmt::print("{}", list_known(flags.robot, flags.lock));
    return kGood;
  });
}
