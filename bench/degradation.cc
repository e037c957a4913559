// SPDX-License-Identifier: Apache-2.0
#include "bench/degradation.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <charconv>
#include <fstream>
#include <nlohmann/json.hpp>
#include <stdexcept>

namespace tauext {
namespace {

using Json = nlohmann::json;

// a field of S by its name
template <class S>
struct Field {
  const char* name;
  const char* unit;
  double S::*at;
};

constexpr Field<Loadcell> kLoadcell[] = {{"scale", "1", &Loadcell::scale},
                                         {"offset", "N", &Loadcell::offset},
                                         {"hysteresis", "of full scale", &Loadcell::hysteresis},
                                         {"nonlinearity", "of full scale", &Loadcell::nonlinearity},
                                         {"noise", "N", &Loadcell::noise},
                                         {"step", "N", &Loadcell::step},
                                         {"full_scale", "N", &Loadcell::full_scale}};

constexpr Field<ModelError> kModelError[] = {{"mass", "1", &ModelError::mass},
                                             {"com", "m", &ModelError::com},
                                             {"friction", "N m", &ModelError::friction},
                                             {"viscous", "N m s/rad", &ModelError::viscous},
                                             {"armature", "kg m^2", &ModelError::armature}};

constexpr Field<Sensors> kSensors[] = {{"velocity_noise", "rad/s", &Sensors::velocity_noise},
                                       {"encoder_step", "rad", &Sensors::encoder_step},
                                       {"loadcell_noise", "N m", &Sensors::loadcell_noise},
                                       {"latency", "s", &Sensors::latency},
                                       {"tau_latency", "s", &Sensors::tau_latency},
                                       {"jitter", "s", &Sensors::jitter},
                                       {"dropped", "1", &Sensors::dropped},
                                       {"repeated", "1", &Sensors::repeated}};

template <class S, std::size_t N>
std::string known(const Field<S> (&fields)[N]) {
  std::vector<std::string> names;
  for (const auto& f : fields) names.push_back(fmt::format("{} [{}]", f.name, f.unit));
  return fmt::format("{}", fmt::join(names, ", "));
}

template <class S, std::size_t N>
double* find(const Field<S> (&fields)[N], std::string_view name, S& s) {
  for (const auto& f : fields) {
    if (f.name == name) return &(s.*f.at);
  }
  return nullptr;
}

template <class S, std::size_t N>
void set_each(const Field<S> (&fields)[N], const std::vector<std::string>& items, S& s) {
  for (const std::string& item : items) {
    const auto equals = item.find('=');
    double* const at = find(fields, std::string_view(item).substr(0, equals), s);
    const char* const end = item.data() + item.size();
    double value = 0;
    if (equals != std::string::npos && at != nullptr) {
      const auto [rest, error] = std::from_chars(item.data() + equals + 1, end, value);
      if (error == std::errc() && rest == end) {
        *at = value;
        continue;
      }
    }
    throw std::invalid_argument(
        fmt::format("'{}' is not KEY=NUMBER with a KEY of {}", item, known(fields)));
  }
}

[[noreturn]] void fail(const std::string& path, const std::string& what) {
  throw std::runtime_error(fmt::format("{}: {}", path, what));
}

double number(const std::string& path, const std::string& key, const Json& value) {
  if (!value.is_number()) fail(path, fmt::format("\"{}\" is {}, no number", key, value.dump()));
  return value.get<double>();
}

template <class S, std::size_t N>
void set_object(const std::string& path, const std::string& in, const Json& object,
                const Field<S> (&fields)[N], S& s) {
  if (!object.is_object()) fail(path, fmt::format("\"{}\" is no object", in));
  for (const auto& [key, value] : object.items()) {
    double* const at = find(fields, key, s);
    if (at == nullptr) {
      fail(path, fmt::format("unknown key \"{}.{}\"; known: {}", in, key, known(fields)));
    }
    *at = number(path, key, value);
  }
}

template <class S, std::size_t N>
void list_changed(const Field<S> (&fields)[N], const S& s, const char* prefix,
                  std::vector<std::string>& out) {
  const S ideal;
  for (const auto& f : fields) {
    if (s.*f.at != ideal.*f.at) out.push_back(fmt::format("{}{}={:g}", prefix, f.name, s.*f.at));
  }
}

}  // namespace

void set_fields(const std::vector<std::string>& items, Sensors& s) {
  set_each(kSensors, items, s);
}

void set_fields(const std::vector<std::string>& items, Loadcell& l) {
  set_each(kLoadcell, items, l);
}

void set_fields(const std::vector<std::string>& items, ModelError& e) {
  set_each(kModelError, items, e);
}

void read_degradation(const std::string& path, Degradation& d) {
  std::ifstream in(path);
  if (!in) fail(path, "cannot open");
  Json document;
  try {
    document = Json::parse(in, nullptr, true, true);  // comments are welcome
  } catch (const Json::exception& e) {
    fail(path, e.what());
  }
  if (!document.is_object()) fail(path, "a JSON object is wanted, like {\"velocity_noise\": 1e-3}");
  Degradation read = d;
  for (const auto& [key, value] : document.items()) {
    if (key == "loadcell") {
      set_object(path, key, value, kLoadcell, read.sensors.loadcell);
    } else if (key == "model_error") {
      set_object(path, key, value, kModelError, read.model_error);
    } else if (key == "seed" && value.is_number_unsigned()) {
      read.sensors.seed = value.get<std::uint64_t>();
    } else if (double* const at = find(kSensors, key, read.sensors)) {
      *at = number(path, key, value);
    } else {
      fail(path, fmt::format("unknown key \"{}\"; known: {}, seed (a whole number), and objects "
                             "loadcell and model_error",
                             key, known(kSensors)));
    }
  }
  d = read;
}

std::string describe(const Degradation& d) {
  std::vector<std::string> all;
  list_changed(kSensors, d.sensors, "", all);
  list_changed(kLoadcell, d.sensors.loadcell, "loadcell.", all);
  list_changed(kModelError, d.model_error, "model_error.", all);
  return fmt::format("{}", fmt::join(all, " "));
}

}  // namespace tauext
