// SPDX-License-Identifier: Apache-2.0
#include "bench/run/scenario_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <initializer_list>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "bench/score/degradation.h"
#include "bench/score/metrics.h"
#include "mjcf/import/json_object.h"
#include "mjcf/scenarios/regions.h"
#include "mjcf/scenarios/touch.h"
#include "mjcf/trace/known.h"
#include "mjcf/trace/printable.h"

namespace tauext {
namespace {

using Json = JsonObject::Json;
using Object = JsonObject;

template <class... Args>
[[noreturn]] void refuse(fmt::format_string<Args...> words, Args&&... args) {
  throw std::invalid_argument(fmt::format(words, std::forward<Args>(args)...));
}

// what a word of an object stands for, of a list of pairs; an unknown one is answered with these
template <class Choices>
auto choice(const Object& o, const char* key, const std::string& word, const Choices& all) {
  try {
    return find_known(all, key, word, [](const auto& c) { return std::string(c.first); }).second;
  } catch (const std::invalid_argument& e) {
    refuse("{}: {}", o.where(), e.what());
  }
}

struct Wave {
  int joint;              // from 0
  double size, w, phase;  // [rad] or [N m], [rad/s], [rad]
};

struct Load {
  Wave wave;
  double from, to;  // [s]
  bool sweep;       // of all frequencies, instead of w and phase

  double operator()(double t) const {
    if (t < from || t >= to) return 0;
    return wave.size * (sweep ? swept_sine(t, from, to) : std::sin(wave.w * t + wave.phase));
  }
};

int joint_of(const Object& o, int dof) {
  const double j = o.number("joint", 1, dof);
  if (j != std::floor(j)) refuse("{}: \"joint\" is {}, no whole number", o.where(), j);
  return static_cast<int>(j) - 1;
}

// of every joint, its moves from way point to way point
std::vector<Moves<MinimumJerk>> moves_of(const Object& o, const Eigen::VectorXd& home,
                                         double duration) {
  std::vector<double> times;
  std::vector<Eigen::VectorXd> points;
  o.each("way_points", [&](const Json& j, const std::string& where) {
    const Object point(j, where, {"t", "q"});
    const double t = point.number("t", 0, duration);
    if (!times.empty() && t <= times.back())
      refuse("{}: \"t\" is {:g}, and must be later than the one before", where, t);
    times.push_back(t);
    points.push_back(point.vector("q", static_cast<int>(home.size())));
  });
  if (points.empty()) {
    times = {0};
    points = {home};
  }
  std::vector<Moves<MinimumJerk>> all;
  for (Eigen::Index i = 0; i < home.size(); ++i) {
    std::vector<MinimumJerk> moves{{.begin = times[0], .from = points[0][i], .to = points[0][i]}};
    for (std::size_t k = 1; k < times.size(); ++k) {
      moves.push_back({.begin = times[k - 1],
                       .duration = times[k] - times[k - 1],
                       .from = points[k - 1][i],
                       .to = points[k][i]});
    }
    all.emplace_back(std::move(moves));
  }
  return all;
}

std::vector<Wave> sines_of(const Object& o, int dof) {
  std::vector<Wave> all;
  o.each("sines", [&](const Json& j, const std::string& where) {
    const Object sine(j, where, {"joint", "amplitude", "w", "phase"});
    all.push_back({joint_of(sine, dof), sine.number("amplitude", -100, 100),
                   sine.number("w", 1e-6, 1e4), sine.number_or("phase", 0, -100, 100)});
  });
  return all;
}

// constant ones are cosines of no frequency
std::vector<Load> loads_of(const Object& o, int dof, double duration) {
  constexpr double kHalfPi = std::numbers::pi / 2;
  constexpr double kShortestSweep = 30;  // [s] for a bandwidth from 0.7 rad/s on
  std::vector<Load> all;
  o.each("loads", [&](const Json& j, const std::string& where) {
    const Object load(j, where, {"joint", "torque", "from", "to", "w", "phase", "sweep"});
    const double w = load.number_or("w", 0, 0, 1e4);
    Load one{{joint_of(load, dof), load.number("torque", -1e6, 1e6), w,
              load.number_or("phase", w == 0 ? kHalfPi : 0, -100, 100)},
             load.number_or("from", 0, 0, duration),
             load.number_or("to", std::numeric_limits<double>::infinity(), 0, Object::kMost),
             load.flag("sweep")};
    if (one.from >= duration)
      refuse("{}: \"from\" is {:g}, the end of the scenario", where, one.from);
    if (one.to <= one.from)
      refuse("{}: \"to\" is {:g}, and must be after \"from\", {:g}", where, one.to, one.from);
    if (one.sweep && (load.has("w") || load.has("phase")))
      refuse("{}: a \"sweep\" has no \"w\" or \"phase\"", where);
    if (one.sweep) one.to = std::min(one.to, duration);
    if (one.sweep && one.to - one.from < kShortestSweep)
      refuse("{}: a \"sweep\" of {:g} s is too short to measure a bandwidth; give it {} s or more",
             where, one.to - one.from, kShortestSweep);
    all.push_back(one);
  });
  return all;
}

// "end_effector", or ["link4", "link5", 0.5]: between two of them
LinkPoint point_of(const Object& o) {
  if (!o.has("at")) return {};
  const Json& at = o.at("at");
  if (at.is_string()) return {at, at, 0};
  const bool between = at.is_array() && at.size() == 3 && at[0].is_string() && at[1].is_string() &&
                       at[2].is_number();
  if (!between)
    refuse(
        "{}: \"at\" is {}, and must be a site or body, like \"end_effector\", or a point between "
        "two, like [\"link4\", \"link5\", 0.5]",
        o.where(), at.dump());
  return {at[0], at[1], at[2]};
}

RegionTouch region_touch(const Json& j, const std::string& where, double duration) {
  constexpr std::pair<const char*, Meeting> kMeetings[] = {
      {"free", Meeting::kFree}, {"grazing", Meeting::kGrazing}, {"clamped", Meeting::kClamped}};
  const Object o(j, where,
                 {"region", "meeting", "t", "at", "direction", "stiffness_factor", "speed",
                  "share_of_limit", "depth", "force", "rise", "hold", "fall"});
  const auto only = [&](Meeting meeting, Meeting other, std::initializer_list<const char*> keys) {
    for (const char* key : keys) {
      if (o.has(key) && meeting != other)
        refuse("{}: a meeting that is '{}' has no \"{}\"", where, o.text("meeting", "free"), key);
    }
  };
  RegionTouch t;
  t.meeting = choice(o, "meeting", o.text("meeting", "free"), kMeetings);
  only(t.meeting, Meeting::kFree, {"speed", "share_of_limit"});
  only(t.meeting, Meeting::kGrazing, {"depth"});
  only(t.meeting, Meeting::kClamped, {"force", "hold", "fall"});
  if (t.meeting == Meeting::kFree && o.has("rise"))
    refuse("{}: a free meeting has no \"rise\"", where);
  o.at("region");
  t.region = &body_region(o.text("region", ""));
  t.begin = o.number("t", 0, duration);
  t.at = point_of(o);
  t.direction = o.vector("direction", 3);
  if (t.direction.isZero()) refuse("{}: \"direction\" is zero", where);
  t.direction.normalize();
  t.stiffness_factor = o.number_or("stiffness_factor", 1, 0.1, 10);
  if (o.has("speed") && o.has("share_of_limit"))
    refuse("{}: \"speed\" and \"share_of_limit\" are two ways to say one thing", where);
  t.share_of_limit = o.number_or("share_of_limit", 0, 1e-3, 10);
  t.speed = o.number_or("speed", 0.25, 1e-3, 5);
  if (t.meeting != Meeting::kFree) t.rise = o.number("rise", 1e-3, 100);
  if (t.meeting == Meeting::kGrazing) t.depth = o.number("depth", 1e-6, 0.1);
  if (t.meeting == Meeting::kClamped) {
    t.force = o.number_or("force", t.region->clamp_limit, 1e-3, 1e4);
    t.hold = o.number_or("hold", 0, 0, 1000);
    t.fall = o.number_or("fall", t.rise, 1e-3, 100);
  }
  return t;
}

// prescribed forces on the end effector
std::vector<Touch> touches_of(const Object& o, double duration) {
  constexpr std::pair<const char*, TouchKind> kKinds[] = {
      {"blow", TouchKind::kBlow}, {"push", TouchKind::kSlowPush}, {"clamp", TouchKind::kClamp}};
  std::vector<Touch> all;
  o.each("touches", [&](const Json& j, const std::string& where) {
    const Object touch(j, where, {"kind", "t", "rise", "hold", "fall", "force"});
    const std::string kind = touch.text("kind", "blow");
    Touch t;
    t.kind = choice(touch, "kind", kind, kKinds);
    t.begin = touch.number("t", 0, duration);
    t.rise = touch.number("rise", 1e-3, 1e3);
    if (t.begin + t.rise > duration)
      refuse("{}: grows from {:g} to {:g} s, and the scenario ends at {:g} s", where, t.begin,
             t.begin + t.rise, duration);
    t.hold = touch.number_or("hold", 0, 0, Object::kMost);
    t.fall = touch.number_or("fall", t.kind == TouchKind::kBlow ? 0 : t.rise, 0, 1e3);
    t.force = touch.vector("force", 3);
    if (t.force.isZero()) refuse("{}: \"force\" is zero", where);
    all.push_back(t);
  });
  return all;
}

// regions of a person's body that meet the arm
std::vector<RegionTouch> regions_of(const Object& o, double duration) {
  std::vector<RegionTouch> all;
  o.each("regions", [&](const Json& j, const std::string& where) {
    try {
      all.push_back(region_touch(j, where, duration));
      check(all);
    } catch (const std::invalid_argument& e) {
      const std::string why = e.what();
      refuse("{}{}", why.starts_with(where) ? "" : where + ": ", why);
    }
  });
  return all;
}

Response response_of(const Object& o) {
  constexpr std::pair<const char*, Response> kAll[] = {{"error", Response::kNone},
                                                       {"step", Response::kStep},
                                                       {"lag", Response::kLag},
                                                       {"detection", Response::kDetection},
                                                       {"bandwidth", Response::kBandwidth}};
  return choice(o, "asks", o.text("asks", "error"), kAll);
}

// there must be something to answer
void check_question(const Object& o, Response asked, const std::vector<Load>& loads, bool touched) {
  const bool is_bandwidth = asked == Response::kBandwidth;
  const auto sweeps = [](const Load& l) { return l.sweep; };
  if (is_bandwidth &&
      (loads.empty() || touched || !std::all_of(loads.begin(), loads.end(), sweeps)))
    refuse(
        "{}: \"asks\" is 'bandwidth', so there must be \"loads\", each with \"sweep\": true, and "
        "nothing else",
        o.where());
  const bool of_load = asked == Response::kStep || asked == Response::kLag;
  if (of_load && loads.empty() && !touched)
    refuse("{}: \"asks\" is '{}', and there are no \"loads\" to answer", o.where(),
           o.text("asks", ""));
  const auto constant = [](const Load& l) { return l.wave.w == 0 && !l.sweep; };
  if (asked == Response::kStep && (touched || !std::all_of(loads.begin(), loads.end(), constant)))
    refuse("{}: \"asks\" is 'step', so there must be constant \"loads\", and nothing else",
           o.where());
  const auto changes = [&](const Load& l) {
    return l.from > 0 || l.to < o.number("duration", 0, Object::kMost) || l.sweep ||
           (asked == Response::kLag && l.wave.w > 0);
  };
  if (of_load && !touched && !std::any_of(loads.begin(), loads.end(), changes))
    refuse("{}: \"asks\" is '{}', and no load {}", o.where(), o.text("asks", ""),
           asked == Response::kLag ? "changes" : "begins or ends within the scenario");
  const double least = o.number_or("score_from", 0, 0, Object::kMost) + metrics::kLongestLag + 0.1;
  if (const double duration = o.number("duration", 0, Object::kMost);
      asked == Response::kLag && duration < least - 1e-9)
    refuse("{}: \"asks\" is 'lag', so \"duration\" must be {:g} or more, not {:g}", o.where(),
           least, duration);
  if (asked == Response::kDetection && !touched)
    refuse("{}: \"asks\" is 'detection', and there are no \"touches\" or \"regions\"", o.where());
}

Scenario scenario_of(const Json& json, const std::string& where, const Robot& robot) {
  const Object of(json, where,
                  {"name", "description", "duration", "score_from", "asks", "way_points", "sines",
                   "loads", "touches", "regions", "degrade", "reaches_limits"});
  Scenario s = quiet();
  s.name = of.text("name", "");
  if (s.name.empty() || s.name.find_first_of("/+@ \t\n") != s.name.npos)
    refuse("{}: \"name\" is '{}', and must be a word without / + @", where, s.name);
  s.description = of.text("description", "of a file");
  s.duration = of.number("duration", 0.1, 3600);
  s.score_from = of.number_or("score_from", 0, 0, s.duration - 0.01);
  s.response = response_of(of);
  s.reaches_limits = of.flag("reaches_limits");
  s.start_on_reference = true;
  s.reference = [moves = moves_of(of, robot.home(), s.duration), sines = sines_of(of, robot.dof())](
                    double t, int i) {
    Reference sum = moves[static_cast<std::size_t>(i)](t);
    for (const Wave& x : sines) {
      if (x.joint != i) continue;
      const Reference r = sine_motion(x.size, x.w, t + x.phase / x.w);
      sum = {sum.q + r.q, sum.qd + r.qd, sum.qdd + r.qdd};
    }
    return sum;
  };
  const std::vector<Load> loads = loads_of(of, robot.dof(), s.duration);
  const std::vector<Touch> touches = touches_of(of, s.duration);
  s.regions = regions_of(of, s.duration);
  check_question(of, s.response, loads, !touches.empty() || !s.regions.empty());
  s.tau_ext = [loads](double t, int i) {
    double sum = 0;
    for (const Load& x : loads) {
      if (x.wave.joint == i) sum += x(t);
    }
    return sum;
  };
  if (of.has("degrade")) {
    Degradation d;
    try {
      set_degradation(of.at("degrade").dump(), d);
    } catch (const std::invalid_argument& e) {
      refuse("{}: degrade: {}", of.where(), e.what());
    }
    if (d.drives != Drives())
      refuse("{}: degrade: drives are the robot's, not the scenario's: --drives", of.where());
    s.sensors = d.sensors;
    s.model_error = d.model_error;
  }
  return with_touches(s, touches);
}

}  // namespace

std::vector<Scenario> read_scenarios(const std::string& path, const Robot& robot) {
  const Json json = read_json(path);
  try {
    const Object file(json, path, {"scenarios"});
    std::vector<Scenario> all;
    file.at("scenarios");
    file.each("scenarios", [&](const Json& j, const std::string& where) {
      all.push_back(scenario_of(j, where, robot));
    });
    if (all.empty()) refuse("{}: there is no scenario in it", path);
    return all;
  } catch (const std::invalid_argument& e) {
    throw std::runtime_error(one_line(e.what()));
  }
}

void add_scenarios(const std::string& path, const Robot& robot) {
  for (const Scenario& s : read_scenarios(path, robot)) {
    try {
      register_scenario_of(robot, s);
    } catch (const std::invalid_argument& e) {
      throw std::runtime_error(fmt::format("{}: {}", path, one_line(e.what())));
    }
  }
}

}  // namespace tauext
