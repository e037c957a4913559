// SPDX-License-Identifier: Apache-2.0
#include "bench/score/degradation.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cstdint>
#include <filesystem>
#include <numbers>
#include <stdexcept>
#include <tuple>

#include "bench/roster/specification.h"
#include "mjcf/import/json_object.h"
#include "mjcf/trace/known.h"
#include "mjcf/trace/printable.h"

namespace tauext {

// what sensors.h and model_error.h take, each checked again where it is used
template <>
struct FieldsOf<Loadcell> {
  static constexpr auto list() {
    using L = Loadcell;
    return std::tuple(
        Field{"scale", &L::scale, "1", 0, 1e3, "gain error; 1: none"},
        Field{"offset", &L::offset, "N", -1e6, 1e6, "added to the force"},
        Field{"hysteresis", &L::hysteresis, "of full scale", 0, 1, "width of the loop"},
        Field{"nonlinearity", &L::nonlinearity, "of full scale", -1, 1, "deviation at half scale"},
        Field{"noise", &L::noise, "N", 0, 1e6, "standard deviation, white"},
        Field{"step", &L::step, "N", 0, 1e6, "readings are whole steps"},
        Field{"full_scale", &L::full_scale, "N", 0, 1e6, "0: 1000 N of a screw, 3000 N m"});
  }
};

template <>
struct FieldsOf<TorqueFaults> {
  static constexpr auto list() {
    using T = TorqueFaults;
    return std::tuple(
        Field{"gain", &T::gain, "1", 0, 0.9, "largest error of a sensor's gain"},
        Field{"hysteresis", &T::hysteresis, "u", 0, 10, "width of the loop; u: what it is used to"},
        Field{"ripple", &T::ripple, "u", 0, 10, "amplitude, a sine of the motor's position"},
        Field{"waves", &T::waves, "1", 0, 1e5, "of the ripple in a turn of the joint"},
        Field{"bias", &T::bias, "u", 0, 10, "largest offset of a sensor"},
        Field{"noise", &T::noise, "u", 0, 10, "standard deviation, white"});
  }
};

template <>
struct FieldsOf<Drives> {
  static constexpr auto list() {
    using D = Drives;
    return std::tuple(
        Field{"stiffness", &D::stiffness, "u/rad", 0, 1e6, "of springs behind motors; 0: rigid"},
        Field{"rotor", &D::rotor, "u s^2/rad", 1e-6, 10, "inertia of these motors"},
        Field{"damping", &D::damping, "1", 0, 2, "of springs, as a share of the critical one"},
        Field{"coulomb", &D::coulomb, "u", 0, 10, "dry friction"},
        Field{"stribeck", &D::stribeck, "1", 0, 10, "how much more it is near rest"},
        Field{"viscous", &D::viscous, "u s/rad", 0, 10, "viscous friction"},
        Field{"drift", &D::drift, "1", 0, 1, "by which friction falls and rises in a run"});
  }
};

template <>
struct FieldsOf<Sensors> {
  static constexpr auto list() {
    using S = Sensors;
    return std::tuple(
        Field{"velocity_noise", &S::velocity_noise, "rad/s", 0, 1e9, "standard deviation, on qd"},
        Field{"encoder_step", &S::encoder_step, "rad", 0, 1, "q is in whole steps"},
        Field{"loadcell_noise", &S::loadcell_noise, "N m", 0, 1e5, "standard deviation, on tau"},
        Field{"latency", &S::latency, "s", 0, 1, "age of q, qd and tau"},
        Field{"tau_latency", &S::tau_latency, "s", 0, 1, "how much older tau is"},
        Field{"jitter", &S::jitter, "s", 0, 1, "largest error of a time stamp"},
        Field{"dropped", &S::dropped, "1", 0, 0.99, "share of samples that are lost"},
        Field{"repeated", &S::repeated, "1", 0, 0.99, "share of samples with the values before"},
        Nested{"loadcell", &S::loadcell}, Nested{"torque", &S::torque});
  }
};

template <>
struct FieldsOf<ModelError> {
  static constexpr auto list() {
    using M = ModelError;
    return std::tuple(
        Field{"mass", &M::mass, "1", 0.01, 100, "factor on the last link's mass and inertia"},
        Field{"com", &M::com, "m", -10, 10, "how much farther its centre of mass is"},
        Field{"friction", &M::friction, "N m", 0, 1e4, "more dry friction of every joint"},
        Field{"friction_share", &M::friction_share, "1", 0, 10,
              "the same, as a share of what the joint is used to"},
        Field{"viscous", &M::viscous, "N m s/rad", 0, 1e4, "more viscous friction"},
        Field{"armature", &M::armature, "kg m^2", 0, 1e4, "more inertia of every rotor"});
  }
};

namespace {

using Json = JsonObject::Json;

template <class S>
void set_keys(const KeyValues& keys, const char* owner, S& s) {
  explaining_keys(owner, field_help<S>(), [&] { set_parameters(keys, s); });
}

template <class S>
void set_items(const std::vector<std::string>& items, const char* owner, S& s) {
  explaining_keys(owner, field_help<S>(), [&] {
    KeyValues keys;
    for (const std::string& item : items) keys.push_back(key_and_value(item));
    set_parameters(keys, s);
  });
}

void add_number(const std::string& key, const Json& value, KeyValues& to) {
  if (!value.is_number()) {
    throw std::invalid_argument(fmt::format("\"{}\" is {}, no number", key, value.dump()));
  }
  to.emplace_back(key, value.dump());
}

// the numbers of an object within the file
void add_object(const std::string& name, const std::string& prefix, const Json& object,
                KeyValues& to) {
  if (!object.is_object()) throw std::invalid_argument(fmt::format("\"{}\" is no object", name));
  for (const auto& [key, value] : object.items()) add_number(prefix + key, value, to);
}

Degradation from_json(const Json& document, Degradation d) {
  if (!document.is_object()) {
    throw std::invalid_argument("a JSON object is wanted, like {\"velocity_noise\": 1e-3}");
  }
  KeyValues sensors, model_error, drives;
  for (const auto& [key, value] : document.items()) {
    if (key == "loadcell" || key == "torque") {
      add_object(key, key + ".", value, sensors);
    } else if (key == "model_error") {
      add_object(key, "", value, model_error);
    } else if (key == "drives") {
      add_object(key, "", value, drives);
    } else if (key == "seed") {
      if (!value.is_number_unsigned()) {
        throw std::invalid_argument(fmt::format("\"seed\" is {}, no whole number", value.dump()));
      }
      d.sensors.seed = value.get<std::uint64_t>();
    } else {
      add_number(key, value, sensors);
    }
  }
  set_keys(sensors, "sensors", d.sensors);
  set_keys(model_error, "model_error", d.model_error);
  set_keys(drives, "drives", d.drives);
  return d;
}

template <class S, class T>
void add_changed(const Field<S, T>& f, const std::string& prefix, const S& s,
                 std::vector<std::string>& out) {
  if (s.*f.at != S().*f.at) out.push_back(fmt::format("{}{}={}", prefix, f.key, s.*f.at));
}

template <class S, class Inner>
void add_changed(const Nested<S, Inner>& n, const std::string& prefix, const S& s,
                 std::vector<std::string>& out) {
  for_each_field<Inner>([&](const auto& f) { add_changed(f, prefix + n.key + ".", s.*n.at, out); });
}

}  // namespace

void set_fields(const std::vector<std::string>& items, Sensors& s) {
  set_items(items, "sensors", s);
}

void set_fields(const std::vector<std::string>& items, Loadcell& l) {
  set_items(items, "loadcell", l);
}

void set_fields(const std::vector<std::string>& items, ModelError& e) {
  set_items(items, "model_error", e);
}

void set_fields(const std::vector<std::string>& items, Drives& d) {
  set_items(items, "drives", d);
}

void set_degradation(const std::string& json, Degradation& d) {
  d = from_json(parse_json(json, true), d);  // comments are welcome
}

const std::vector<NamedDegradation>& named_degradations() {
  constexpr double kTurnOf17Bits = 2 * std::numbers::pi / (1 << 17);  // [rad]
  static const std::vector<NamedDegradation> all = {
      {"light",
       "a light arm's joints: little friction that nobody knows, rigid drives",
       {.sensors = {.velocity_noise = 1e-4, .torque = {.noise = 0.0005}},
        .drives = {.coulomb = 0.0012}}},
      {"typical",
       "elastic drives, 15 % of an industrial arm's friction unknown, last link 2 % heavier",
       {.sensors = {.velocity_noise = 1e-3,
                    .encoder_step = kTurnOf17Bits,
                    .torque = {.gain = 0.05,
                               .hysteresis = 0.002,
                               .ripple = 0.01,
                               .bias = 0.005,
                               .noise = 0.005},
                    .tau_latency = 0.002},
        .model_error = {.mass = 1.02},
        .drives = {.stiffness = 200,
                   .coulomb = 0.011,
                   .stribeck = 0.3,
                   .viscous = 0.019,
                   .drift = 0.05}}},
      {"hard",
       "soft drives, half of an industrial arm's friction unknown, last link 5 % heavier",
       {.sensors = {.velocity_noise = 3e-3,
                    .encoder_step = kTurnOf17Bits,
                    .torque = {.gain = 0.12,
                               .hysteresis = 0.002,
                               .ripple = 0.03,
                               .bias = 0.015,
                               .noise = 0.02},
                    .tau_latency = 0.008},
        .model_error = {.mass = 1.05},
        .drives = {
            .stiffness = 60, .coulomb = 0.037, .stribeck = 0.3, .viscous = 0.062, .drift = 0.2}}}};
  return all;
}

void read_degradation(const std::string& path, Degradation& d) {
  for (const NamedDegradation& named : named_degradations()) {
    if (named.name != path) continue;
    const std::uint64_t seed = d.sensors.seed;
    d = named.degradation;
    d.sensors.seed = seed;
    return;
  }
  if (path.find_first_of("./") == std::string::npos && !std::filesystem::exists(path)) {
    std::vector<std::string> known;
    for (const NamedDegradation& named : named_degradations()) known.push_back(named.name);
    throw unknown("degradation", path, known);
  }
  const Json json = read_json(path, true);
  try {
    d = from_json(json, d);
  } catch (const std::exception& e) {
    throw std::runtime_error(fmt::format("{}: {}", path, one_line(e.what())));
  }
}

std::string describe(const Degradation& d) {
  std::vector<std::string> all;
  for_each_field<Sensors>([&](const auto& f) { add_changed(f, "", d.sensors, all); });
  for_each_field<ModelError>(
      [&](const auto& f) { add_changed(f, "model_error.", d.model_error, all); });
  for_each_field<Drives>([&](const auto& f) { add_changed(f, "drives.", d.drives, all); });
  return fmt::format("{}", fmt::join(all, " "));
}

}  // namespace tauext
