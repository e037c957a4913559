// SPDX-License-Identifier: Apache-2.0
#include "bench/logs/read_log.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <limits>
#include <numbers>
#include <optional>
#include <stdexcept>
#include <string_view>
#include <utility>
#include <vector>

#include "bench/logs/lcm_reader.h"
#include "bench/logs/lcm_trace.h"
#include "mjcf/trace/printable.h"

namespace tauext {
namespace {

using Eigen::VectorXd;

constexpr double kSlowStep = 0.0105;  // [s] of 100 samples a second, with some jitter

// what was left out, if anything
void report_skipped(const SkippedRows& s, const std::string& log) {
  for (const std::string& note : s.notes) say(log + ": " + note);
  if (s.total() == 0) return;
  say(fmt::format(
      "{}: skipped {} row{}: {} with a wrong number of fields, {} not a number, {} empty "
      "or not finite, {} with a time that is not the next one{}",
      log, s.total(), s.total() == 1 ? "" : "s", s.wrong_field_count, s.not_a_number, s.not_finite,
      s.time_order, s.alone == 0 ? "" : fmt::format(", {} that nothing is joined to", s.alone)));
  for (const std::string& line : s.first) say("  " + line);
  if (s.total() > static_cast<int>(s.first.size())) say("  ...");
}

// by its first bytes, those of an event
bool begins_as_lcm_log(const std::string& path) {
  std::array<char, 4> begin{};
  std::ifstream(path, std::ios::binary).read(begin.data(), begin.size());
  return std::string_view(begin.data(), begin.size()) == "\xED\xA1\xDA\x01";
}

}  // namespace

namespace detail {

// whether t, q and qd can be in s, rad and rad/s
class UnitDoubt {
 public:
  UnitDoubt(int joints, double velocity_delay)
      : least_(VectorXd::Constant(joints, kNever)),
        most_(-least_),
        joints_(joints),
        apart_(Eigen::MatrixXd::Zero(joints, joints)),
        velocity_delay_(velocity_delay) {}

  // the next sample
  void take(const Sample& s) {
    least_ = least_.cwiseMin(s.q);
    most_ = most_.cwiseMax(s.q);
    ++samples_;
    if (longest_ > 0) return take_step(s);
    first_.push_back(s);
    if (first_.size() == kFirst) settle();
  }
  // no more samples follow
  void finish() {
    if (first_.size() > 1) settle();
  }

  const VectorXd& least() const { return least_; }
  const VectorXd& most() const { return most_; }

  // whether q and qd cannot both be
  bool contradicts() const {
    for (std::size_t j = 0; j < joints_.size(); ++j) {
      if (is_wrong(j) || is_late(j)) return true;
    }
    return false;
  }

  // "" or which joint's speed is rather noise than motion
  std::string words_of_noise() const {
    for (std::size_t j = 0; j < joints_.size(); ++j) {
      if (!is_noise(j)) continue;
      return fmt::format(
          "qd{} is rather noise than motion, {:.2g} of {:.2g} rad/s (or m/s): if it is the "
          "difference of a coarse q, a map (--columns) with [t], [q] and [tau] and without [qd] "
          "has "
          "it made of q, filtered (`velocity_filter`)",
          j + 1, std::sqrt(joints_[j].noise / joints_[j].steps),
          std::sqrt(joints_[j].speed / joints_[j].steps));
    }
    return "";
  }

  // says what can hardly be
  void tell(const std::string& path, const std::string& remedy) const {
    constexpr double kTwoTurns = 12.6;    // [rad]
    constexpr double kLongestStep = 0.1;  // [s]
    for (std::size_t j = 0; j < joints_.size(); ++j) {
      if (!is_wrong(j)) continue;
      const Joint& sum = joints_[j];
      const std::string what =
          rests(sum)    ? fmt::format("q{} moves, and qd{} says that it rests", j + 1, j + 1)
          : stands(sum) ? fmt::format("q{} rests, and qd{} says that it moves", j + 1, j + 1)
          : says_of(j) != j
              ? fmt::format(
                    "q{} moves as qd{} says, and not as qd{}, so that `columns` of [qd] in a "
                    "map (--columns) may be in another order, or else",
                    j + 1, says_of(j) + 1, j + 1)
          : sum.alike() < kForeign
              ? fmt::format("q{} moves otherwise than qd{} says, as if that were another joint's",
                            j + 1, j + 1)
              : fmt::format("q{} moves {:.3g} times as fast as qd{} says", j + 1, sum.yy / sum.xy,
                            j + 1);
      say(fmt::format("{}: {}: {}", path, what, remedy));
      break;
    }
    for (std::size_t j = 0; j < joints_.size(); ++j) {
      if (is_wrong(j) || !is_late(j)) continue;
      const double late = joints_[j].late();
      say(fmt::format(
          "{}: qd{} comes {:.0f} ms {} the motion of q{}: are both stamped by one clock, "
          "and is qd new in each sample?",
          path, j + 1, 1000 * std::abs(late), late > 0 ? "after" : "before", j + 1));
      break;
    }
    const VectorXd size = least_.cwiseAbs().cwiseMax(most_.cwiseAbs());
    for (Eigen::Index j = 0; j < size.size(); ++j) {
      if (!(size[j] > kTwoTurns)) continue;
      say(fmt::format("{}: q{} reaches {:.3g}, more than two turns: {}", path, j + 1, size[j],
                      remedy));
      break;
    }
    if (samples_ > 2 && longest_ > kGap * kLongestStep)
      say(fmt::format("{}: the samples are {:.3g} apart: {}", path, longest_ / kGap, remedy));
    if (contradicts())
      say(path + ": q and qd contradict each other, so that no estimate from them means anything");
  }

 private:
  static constexpr double kNever = std::numeric_limits<double>::infinity();

  // sums over windows of the motion by qd (x) and by q (y), and of how qd changes in them (a)
  struct Joint {
    double x = 0, y = 0;                      // of the window
    double from = 0;                          // [rad/s] qd at its begin
    double xx = 0, xy = 0, yy = 0, path = 0;  // of |x|
    double xa = 0, ya = 0, aa = 0;
    // [(rad/s)^2] squares of qd, and of its noise by second differences, in windows that it moves
    double speed = 0, noise = 0, steps = 0;
    double own_speed = 0, own_noise = 0, own_steps = 0;  // of the window
    double way = 0, least = 0, most = 0;                 // [rad] q since the begin, without gaps

    double alike() const { return std::abs(xy) / std::sqrt(xx * yy); }
    // [s] of qd behind q, where y = x + late a
    double late() const { return (ya - xa) / aa; }
    // [rad^2] of y, without and with that
    double rest() const { return xx - 2 * xy + yy; }
    double rest_of_late() const { return std::max(rest() - late() * (ya - xa), 1e-9 * yy); }
  };

  static bool rests(const Joint& sum) { return sum.xx < 1e-6 * sum.yy; }
  static bool stands(const Joint& sum) { return sum.yy < 1e-7 * sum.xx && sum.xx > 0.01; }

  // the joint of which q of this one tells, by qd; itself, unless another's fits ten times better
  std::size_t says_of(std::size_t j) const {
    constexpr double kFits = 0.01;   // [1] of q's squares
    constexpr double kSlope = 0.99;  // [1] of correlation: else its unit or sign is another one
    Eigen::Index best = 0;
    const auto at = static_cast<Eigen::Index>(j);
    const double own = apart_(at, at), least = apart_.row(at).minCoeff(&best);
    const bool other = joints_[j].alike() < kSlope && own > kFits * joints_[j].yy &&
                       10 * least < std::min(own, joints_[j].yy);
    return other ? static_cast<std::size_t>(best) : j;
  }

  bool is_wrong(std::size_t j) const {
    constexpr double kMoved = 0.1;    // [rad], more than a joint at rest trembles
    constexpr double kNudged = 0.02;  // [rad], more than it creeps in steps of its encoder
    constexpr double kSame = 0.99, kMostSlip = 0.05;  // [1] of correlation, of the speed
    const Joint& sum = joints_[j];
    const double range = sum.most - sum.least;
    if (stands(sum)) return true;
    if (rests(sum)) return range > kMoved;
    if (std::max(range, sum.path) < kNudged) return false;
    if (range > kMoved && (sum.alike() < kForeign || says_of(j) != j)) return true;
    // q fixes the speed exactly: a slope other than 1 is another rate or unit
    if (longest_ < kCoarse && range > kMoved && sum.alike() > kSame &&
        std::abs(sum.xy / sum.yy - 1) > kMostSlip)
      return true;
    return sum.alike() > 0.9 && (sum.xy > 2 * sum.xx || sum.xy < 0.5 * sum.xx);
  }

  bool is_noise(std::size_t j) const {
    constexpr double kMostNoise = 0.4, kLittle = 0.05;  // [1], [rad/s]
    constexpr double kFewestSteps = 100;
    const Joint& sum = joints_[j];
    return longest_ < kCoarse && sum.steps > kFewestSteps &&
           sum.noise > kMostNoise * kMostNoise * sum.speed &&
           sum.noise > kLittle * kLittle * sum.steps;
  }

  // whether qd is that of another time than q, beyond chance and beyond a filter's delay
  bool is_late(std::size_t j) const {
    constexpr double kLate = 0.015;             // [s] less may be a filter's
    constexpr double kWorth = 2.25, kSure = 6;  // [1] of mean squares, of standard errors
    constexpr double kFewest = 20;              // windows
    const Joint& sum = joints_[j];
    if (windows_ < kFewest || !(sum.aa > 0) || std::abs(sum.late() - velocity_delay_) < kLate)
      return false;
    const double rest = sum.rest_of_late(), error = std::sqrt(rest / windows_ / sum.aa);
    return sum.rest() > kWorth * rest && std::abs(sum.late()) > kSure * error;
  }

  // takes the first samples, whose median step tells what a gap is
  void settle() {
    std::vector<double> steps;
    for (std::size_t k = 1; k < first_.size(); ++k) steps.push_back(first_[k].t - first_[k - 1].t);
    const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
    std::nth_element(steps.begin(), middle, steps.end());
    longest_ = kGap * *middle;
    before_last_ = last_ = first_.front();
    for (std::size_t j = 0; j < joints_.size(); ++j)
      joints_[j].from = last_.qd[static_cast<Eigen::Index>(j)];
    for (std::size_t k = 1; k < first_.size(); ++k) take_step(first_[k]);
    first_.clear();
  }

  void take_step(const Sample& s) {
    const double h = s.t - last_.t;
    for (std::size_t j = 0; j < joints_.size() && h <= longest_; ++j) {
      const auto at = static_cast<Eigen::Index>(j);
      const double x = h * (s.qd[at] + last_.qd[at]) / 2;
      double y = s.q[at] - last_.q[at];
      if (std::abs(y) > kHalfTurn) y = std::remainder(y, 2 * std::numbers::pi);  // wrapped
      Joint& sum = joints_[j];
      sum.x += x, sum.y += y, sum.way += y;
      sum.least = std::min(sum.least, sum.way), sum.most = std::max(sum.most, sum.way);
      sum.path += std::abs(x);
      if (!(last_.t - before_last_.t <= longest_)) continue;
      sum.own_noise += std::pow(s.qd[at] - 2 * last_.qd[at] + before_last_.qd[at], 2) / 6;
      sum.own_speed += last_.qd[at] * last_.qd[at];
      ++sum.own_steps;
    }
    before_last_ = std::exchange(last_, s);
    const Sample& before = before_last_;
    if (s.t - window_ < kWindow && h <= longest_) return;
    window_ = s.t;
    ++windows_;
    for (std::size_t j = 0; j < joints_.size(); ++j)
      for (std::size_t k = 0; k < joints_.size(); ++k)
        apart_(static_cast<Eigen::Index>(j), static_cast<Eigen::Index>(k)) +=
            std::pow(joints_[j].y - joints_[k].x, 2);
    for (std::size_t j = 0; j < joints_.size(); ++j) {
      const auto at = static_cast<Eigen::Index>(j);
      Joint& sum = joints_[j];
      const double a = (h <= longest_ ? s : before).qd[at] - sum.from;
      sum.xx += sum.x * sum.x, sum.xy += sum.x * sum.y, sum.yy += sum.y * sum.y;
      sum.xa += sum.x * a, sum.ya += sum.y * a, sum.aa += a * a;
      if (std::abs(sum.y) > kCreeps)
        sum.speed += sum.own_speed, sum.noise += sum.own_noise, sum.steps += sum.own_steps;
      sum.own_speed = sum.own_noise = sum.own_steps = 0;
      sum.x = sum.y = 0, sum.from = s.qd[at];
    }
  }

  static constexpr std::size_t kFirst = 1000;
  static constexpr double kGap = 5;                // [1] usual steps, from which on one is a gap
  static constexpr double kCoarse = kGap * 0.026;  // [s] slower samples miss what is between
  static constexpr double kWindow = 0.1;           // [s]
  static constexpr double kCreeps = 2e-3;          // [rad] in it
  static constexpr double kHalfTurn = 3;   // [rad] more than which no joint moves in a sample
  static constexpr double kForeign = 0.5;  // [1] correlation of what is another joint's

  VectorXd least_, most_;
  std::vector<Joint> joints_;
  Eigen::MatrixXd apart_;      // [rad^2] squares of the motion of a row's q without a column's qd
  double velocity_delay_;      // [s] of qd, where the reader makes it of q
  double windows_ = 0;         // so many
  std::vector<Sample> first_;  // until they are kFirst, or all
  Sample last_, before_last_;
  std::int64_t samples_ = 0;
  double longest_ = 0;       // [s] over a gap qd says nothing; 0 until settle()
  double window_ = -kNever;  // [s] where it began
};

// whether a joint's q, qd or tau is new in every kth sample only, and another in each; or whether
// its tau stays the same, though it moves
class Repeats {
 public:
  void take(double t, const VectorXd& q, const VectorXd& qd, const VectorXd& tau) {
    const VectorXd* const quantities[] = {&q, &qd, &tau};
    channels_.resize(3 * static_cast<std::size_t>(q.size()));
    for (std::size_t c = 0; c < channels_.size(); ++c) {
      const auto joint = static_cast<Eigen::Index>(c / 3);
      Channel& channel = channels_[c];
      channel.take((*quantities[c % 3])[joint]);
      if (c % 3 == kTau) channel.look(t, q[joint]);
    }
    if (samples_++ == 0) from_ = t;
    to_ = t;
  }

  // "" or what
  std::string words() const {
    for (std::size_t c = kTau; c < channels_.size(); c += 3)
      if (channels_[c].changes && channels_[c].stuck)  // one that never changes is no torque
        return fmt::format(
            "tau of joint {} stays the same, bit for bit, from t = {:.6g} s on, though the joint "
            "moves: does its sensor still measure?",
            c / 3 + 1, channels_[c].stuck_from);
    constexpr double kOld = 0.0045;  // [s] less than half of it matters to nobody
    const double step = samples_ < 2 ? 0 : (to_ - from_) / static_cast<double>(samples_ - 1);
    int least = kMostAge;
    for (const Channel& one : channels_) least = std::min(least, one.usual_age());
    std::string all;
    for (const std::size_t quantity : {0, 1, 2}) {
      std::vector<std::size_t> joints;
      int oldest = 0;
      for (std::size_t c = quantity; c < channels_.size(); c += 3) {
        const int age = channels_[c].usual_age();
        if (age <= 2 * least || age * step < kOld) continue;
        joints.push_back(c / 3 + 1);
        oldest = std::max(oldest, age);
      }
      if (joints.empty()) continue;
      constexpr const char* kNames[] = {"q", "qd", "tau"};
      all += fmt::format("{}{}{} is new in every {}th sample only", all.empty() ? "" : ", ",
                         kNames[quantity],
                         3 * joints.size() == channels_.size()
                             ? ""
                             : fmt::format(" of joint{} {}", joints.size() == 1 ? "" : "s",
                                           fmt::join(joints, ", ")),
                         oldest);
    }
    if (all.empty()) return "";
    return all +
           ", so that it is of another time than the others: keep only samples in which all "
           "are new, or record them at one rate";
  }

 private:
  static constexpr std::size_t kTau = 2;
  static constexpr int kMostAge = 100;  // [samples]

  struct Channel {
    double last = 0, least_change = std::numeric_limits<double>::infinity();  // not 0
    int age = 0;                                                              // [samples] of it
    std::array<int, kMostAge + 1> ages{};                      // that it reached, how often
    double from = 0, least_q = 0, most_q = 0;                  // [s], [rad] since it is what it is
    bool changes = false, stuck = false, by_one_step = false;  // by which it came to what it is
    bool rounded = false;   // so that it stays the same for long, and then goes on by one step
    bool went_on = false;   // after it was stuck
    double stuck_from = 0;  // [s]

    void take(double now) {
      if (age > 0 && now == last) {
        ++age;
        return;
      }
      const double change = std::abs(now - last);
      // an encoder's single step comes in every kth sample at a constant speed, too
      if (age > 0 && change > 1.5 * least_change)
        ++ages[static_cast<std::size_t>(std::min(age, kMostAge))];
      by_one_step = changes && change < 1.5 * least_change;
      if (age > 0) least_change = std::min(least_change, change);
      changes = changes || age > 0;
      last = now, age = 1;
    }

    // whether it is the same for long, in which its joint moves far
    void look(double t, double q) {
      constexpr double kLong = 0.5, kFar = 0.1;  // [s], [rad]
      if (age == 1) {
        if (stuck && !went_on) went_on = true, rounded = by_one_step, stuck = !rounded;
        from = t, least_q = most_q = q;
      }
      least_q = std::min(least_q, q), most_q = std::max(most_q, q);
      if (stuck || rounded || t - from < kLong || most_q - least_q < kFar) return;
      stuck = true, stuck_from = from;
    }

    // [samples] that nearly all of them have, one more or less; else 1
    int usual_age() const {
      constexpr int kFewest = 50;
      constexpr double kNearlyAll = 0.9;
      double count = 0, most = 0;
      int usual = 1;
      for (std::size_t samples = 1; samples < ages.size(); ++samples) {
        count += ages[samples];
        const double alike = ages[samples] + (samples + 1 < ages.size() ? ages[samples + 1] : 0);
        if (ages[samples] > 0 && alike > most) most = alike, usual = static_cast<int>(samples);
      }
      return count >= kFewest && most > kNearlyAll * count ? usual : 1;
    }
  };
  std::vector<Channel> channels_;  // q, qd and tau of each joint
  std::int64_t samples_ = 0;
  double from_ = 0, to_ = 0;  // [s]
};

}  // namespace detail

struct LogReader::Impl {
  Impl(const std::string& p, const LogOptions& o) : path(p), mapped(!o.columns.empty()) {
    if (std::filesystem::is_fifo(path))
      throw std::runtime_error(path +
                               ": is a pipe, and a log is read from its begin more than "
                               "once: save it to a file first");
    if (is_lcm_log(path) || begins_as_lcm_log(path)) {
      if (mapped)
        throw std::invalid_argument(fmt::format("{}: an LCM log has no columns to map", path));
      lcm = std::make_unique<LcmReader>(path, o.channel);
      source = lcm.get();
    } else {
      rows = std::make_unique<RecordingReader>(
          path, RecordingOptions{.columns = o.columns, .topic = o.channel, .joints = o.joints});
      source = rows.get();
    }
    contents = source->contents();
    if (contents.tau_is_current && !o.has_robot)
      throw std::runtime_error(
          path +
          ": [current] needs `gain` [N m/A], a number for each drive, in the map of columns");
    if (contents.without_gravity && !o.has_robot)
      throw std::runtime_error(path + ": [tau_without_gravity] needs a robot, which adds gravity");
    doubt = std::make_unique<detail::UnitDoubt>(contents.dof, contents.velocity_delay);
    if (o.contacts == nullptr) return;
    labels.emplace(*o.contacts, path), labels_file = o.contacts;
    own_labels = std::exchange(contents.has_contact, true);
  }

  // of the file beside it, if there is one
  void label(RecordedSample& s) {
    if (!labels) return;
    const bool own = s.contact != 0;
    s.contact = labels->at(s.t);
    differing += own_labels && own != (s.contact != 0);
  }

  std::string path;
  bool mapped;
  std::unique_ptr<LcmReader> lcm;
  std::unique_ptr<RecordingReader> rows;
  SampleSource* source = nullptr;  // the one that there is
  RecordingContents contents;
  std::shared_ptr<const ContactsFile> labels_file;
  std::optional<ContactLabels> labels;  // of it
  bool own_labels = false;              // which the log has, too
  std::int64_t differing = 0;           // samples
  VectorXd tau;                         // of the last sample, as it was read
  VectorXd gain;  // [N m/A] of the drives, if tau is to be made of currents; or [1]
  std::function<VectorXd(const VectorXd&)> gravity;  // [N m] of q, if it is to be added to tau
  std::unique_ptr<detail::UnitDoubt> doubt;
  detail::Repeats repeats;
};

LogReader::LogReader(const std::string& path, const LogOptions& options)
    : impl_(std::make_unique<Impl>(path, options)) {}
LogReader::~LogReader() = default;

void LogReader::use_gains(const VectorXd& gain) {
  if (!impl_->contents.tau_is_current) return;
  require_gains(gain, impl_->contents.dof);
  impl_->gain = gain;
  impl_->contents.tau_is_current = false;
}

void LogReader::scale_torques(const VectorXd& by) {
  if (!impl_->contents.tau_is_current) impl_->gain = by;
}

void LogReader::use_gravity(std::function<VectorXd(const VectorXd&)> gravity) {
  if (!impl_->contents.without_gravity) return;
  impl_->gravity = std::move(gravity);
  impl_->contents.without_gravity = false;
}

const RecordingContents& LogReader::contents() const {
  return impl_->contents;
}
const Regularity& LogReader::regularity() const {
  return impl_->source->regularity();
}
const VectorXd& LogReader::least() const {
  return impl_->doubt->least();
}
const VectorXd& LogReader::most() const {
  return impl_->doubt->most();
}
const VectorXd& LogReader::recorded_tau() const {
  return impl_->tau;
}
bool LogReader::contradicts() const {
  return impl_->doubt->contradicts();
}

bool LogReader::usable() const {
  return skipped() <= regularity().samples && !contradicts() && impl_->repeats.words().empty() &&
         impl_->doubt->words_of_noise().empty();
}

bool LogReader::next(RecordedSample& s) {
  if (!impl_->source->next(s)) {
    impl_->doubt->finish();
    if (!impl_->labels) return false;
    if (impl_->rows && impl_->rows->skipped().set_back > 0 &&
        !impl_->labels_file->of(impl_->path).empty())
      throw std::invalid_argument(
          fmt::format("{}: its clock was set back, so a time in {} can mean two samples: save the "
                      "rows before and after that as two logs",
                      impl_->path, impl_->labels_file->path()));
    impl_->labels->finish();
    return false;
  }
  impl_->label(s);
  impl_->tau = s.tau;
  impl_->repeats.take(s.t, s.q, s.qd, s.tau);
  if (impl_->gain.size() > 0) s.tau = impl_->gain.cwiseProduct(s.tau);
  if (impl_->gravity) s.tau += impl_->gravity(s.q);
  impl_->doubt->take(s);
  return true;
}

std::int64_t LogReader::skipped() const {
  if (impl_->rows) return impl_->rows->skipped().total();
  const LogReport found = impl_->lcm->report();
  return found.rejected + found.out_of_order;
}

void LogReader::report() const {
  const Impl& i = *impl_;
  std::string remedy =
      "are t, q and qd in s, rad and rad/s, with the same sign (and `rate` right, if t is "
      "counted)?";
  if (i.rows) {
    report_skipped(i.rows->skipped(), i.path);
    if (i.mapped || regularity().gaps > 0) say(i.path + ": " + regularity().in_words());
    remedy += " --columns takes other units and signs";
  } else if (const std::string faults = i.lcm->report().in_words(); !faults.empty()) {
    say(fmt::format("{}: channel {}: {}", i.path, i.lcm->report().channel, faults));
  }
  if (i.differing > 0)
    say(fmt::format(
        "{}: its own labels are not used, and are others than those of {} in {} samples", i.path,
        i.labels_file->path(), i.differing));
  i.doubt->tell(i.path, remedy);
  for (const std::string& why : {i.doubt->words_of_noise(), i.repeats.words()})
    if (!why.empty()) say(i.path + ": " + why);
  if (const double step = regularity().step; step > kSlowStep)
    say(fmt::format(
        "{}: {:.3g} samples a second. An estimate is a sample late, {:.3g} ms here, and "
        "a touch that is shorter can be missed: record 100 a second or more",
        i.path, 1 / step, 1000 * step));
  if (skipped() > regularity().samples)
    say(fmt::format("{}: most of it could not be used: {} skipped, {} used", i.path, skipped(),
                    regularity().samples));
}

void RecordedLog::require_consistent(const std::string& path) const {
  if (contradicts)
    throw std::invalid_argument(path + ": q and qd contradict each other, so nothing is learnt");
}

RecordedLog read_any_log(const std::string& path, const LogOptions& o) {
  LogReader reader(path, o);
  Trace trace = trace_of(reader);
  reader.report();
  return {std::move(trace), reader.contradicts(), !reader.usable(),
          reader.contents().velocity_delay};
}

}  // namespace tauext
