// SPDX-License-Identifier: Apache-2.0
#include "bench/run/scenario_touches.h"

#include <fmt/format.h>

#include <initializer_list>
#include <stdexcept>
#include <utility>

namespace tauext {
namespace {

using Json = JsonObject::Json;

// "end_effector", or ["link4", "link5", 0.5]: between two of them
LinkPoint point_of(const JsonObject& o) {
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
  const JsonObject o(j, where,
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

}  // namespace

std::vector<Touch> touches_of(const JsonObject& o, double duration) {
  constexpr std::pair<const char*, TouchKind> kKinds[] = {
      {"blow", TouchKind::kBlow}, {"push", TouchKind::kSlowPush}, {"clamp", TouchKind::kClamp}};
  std::vector<Touch> all;
  o.each("touches", [&](const Json& j, const std::string& where) {
    const JsonObject touch(j, where, {"kind", "t", "rise", "hold", "fall", "force"});
    const std::string kind = touch.text("kind", "blow");
    Touch t;
    t.kind = choice(touch, "kind", kind, kKinds);
    t.begin = touch.number("t", 0, duration);
    t.rise = touch.number("rise", 1e-3, 1e3);
    if (t.begin + t.rise > duration)
      refuse("{}: grows from {:g} to {:g} s, and the scenario ends at {:g} s", where, t.begin,
             t.begin + t.rise, duration);
    t.hold = touch.number_or("hold", 0, 0, JsonObject::kMost);
    t.fall = touch.number_or("fall", t.kind == TouchKind::kBlow ? 0 : t.rise, 0, 1e3);
    t.force = touch.vector("force", 3);
    if (t.force.isZero()) refuse("{}: \"force\" is zero", where);
    all.push_back(t);
  });
  return all;
}

std::vector<RegionTouch> regions_of(const JsonObject& o, double duration) {
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

}  // namespace tauext
