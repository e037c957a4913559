// SPDX-License-Identifier: Apache-2.0
#include "mjcf/import/measured_terms.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <stdexcept>
#include <utility>
#include <vector>

#include "mjcf/import/xml.h"
#include "mjcf/trace/known.h"

namespace tauext::detail {
namespace {

constexpr const char* kOrientations[] = {"quat", "axisangle", "xyaxes", "zaxis", "euler"};

// elements of bodies, by their names
using Elements = std::map<std::string, XMLElement*>;
Elements named(XMLElement& root, std::string_view kind) {
  Elements all;
  each(root, [&](XMLElement& e) {
    if (name_of(e) == kind && (parent_name(e) == "body" || parent_name(e) == "worldbody"))
      all.emplace(text(e, "name"), &e);
    return true;
  });
  return all;
}

XMLElement& find(const Elements& all, const char* what, const std::string& name) {
  const auto at = all.find(name);
  if (at != all.end()) return *at->second;
  std::vector<std::string> names;
  for (const auto& [known, element] : all)
    if (!known.empty()) names.push_back(known);
  throw std::runtime_error(unknown(what, name, names).what());
}

// as text that reads as the same number
std::string exact(double x) {
  return fmt::format("{:.17g}", x);
}

void set(XMLElement& e, const char* attribute, const std::optional<double>& value) {
  if (value) e.SetAttribute(attribute, exact(*value).c_str());
}

// its first two numbers; 0 where there are none
std::pair<double, double> remove_numeric(XMLElement& root, std::string_view name) {
  std::pair<double, double> numbers;
  each(root, [&](XMLElement& e) {
    if (name_of(e) != "numeric" || text(e, "name") != name) return true;
    const std::vector<double> data = numbers_in(text(e, "data"));
    if (!data.empty()) numbers.first = data[0];
    if (data.size() > 1) numbers.second = data[1];
    e.Parent()->DeleteChild(&e);
    return false;
  });
  return numbers;
}

void put_payload(XMLElement& root, const Payload& p) {
  const Elements bodies = named(root, "body"), sites = named(root, "site");
  const auto site = sites.find(p.body);
  XMLElement& body = bodies.count(p.body) > 0 || site == sites.end()
                         ? find(bodies, "body", p.body)
                         : *site->second->Parent()->ToElement();
  // a body of its own stands in the frame of the site, and turns with the one that carries it
  XMLElement* const weight = body.InsertNewChildElement("body");
  if (bodies.count(p.body) == 0) {
    for (const char* a : kOrientations)
      if (site->second->Attribute(a) != nullptr)
        weight->SetAttribute(a, site->second->Attribute(a));
    if (site->second->Attribute("pos") != nullptr)
      weight->SetAttribute("pos", site->second->Attribute("pos"));
  }
  XMLElement* const inertial = weight->InsertNewChildElement("inertial");
  inertial->SetAttribute(
      "pos", fmt::format("{:.17g} {:.17g} {:.17g}", p.center[0], p.center[1], p.center[2]).c_str());
  inertial->SetAttribute("mass", exact(p.mass).c_str());
  // of a ball of water's density
  const double r = std::cbrt(p.mass / 4189), I = 0.4 * p.mass * r * r;
  inertial->SetAttribute("diaginertia", fmt::format("{0:.17g} {0:.17g} {0:.17g}", I).c_str());
}

}  // namespace

void put_measured(XMLElement& mujoco, const MeasuredTerms& terms) {
  const Elements joints = named(mujoco, "joint");
  XMLElement* custom = nullptr;
  for (const auto& [name, t] : terms.joints) {
    XMLElement& joint = find(joints, "joint", name);
    set(joint, "armature", t.armature);
    set(joint, "frictionloss", t.coulomb);
    set(joint, "damping", t.viscous);
    if (t.effort || t.velocity) {
      const auto [torque, speed] = remove_numeric(mujoco, std::string(kRated) + name);
      put_rated(mujoco, name, t.effort.value_or(torque), t.velocity.value_or(speed));
    }
    if (!t.offset && !t.viscous_skew && !t.gain && !t.torque_gain) continue;
    const std::string place = std::string(kMeasured) + name;
    remove_numeric(mujoco, place);
    if (custom == nullptr) custom = mujoco.InsertNewChildElement("custom");
    XMLElement* const numbers = custom->InsertNewChildElement("numeric");
    numbers->SetAttribute("name", place.c_str());
    numbers->SetAttribute("data", fmt::format("{:.17g} {:.17g} {:.17g} {:.17g}",
                                              t.offset.value_or(0), t.viscous_skew.value_or(0),
                                              t.gain.value_or(0), t.torque_gain.value_or(0))
                                      .c_str());
  }
  if (terms.payload) put_payload(mujoco, *terms.payload);
}

void put_rated(XMLElement& mujoco, const std::string& joint, double torque, double speed) {
  const auto known = [](double x) { return x > 0 && std::isfinite(x) ? x : 0; };
  torque = known(torque), speed = known(speed);
  if (torque == 0 && speed == 0) return;
  XMLElement* const number =
      mujoco.InsertNewChildElement("custom")->InsertNewChildElement("numeric");
  number->SetAttribute("name", (std::string(kRated) + joint).c_str());
  number->SetAttribute("data", (exact(torque) + " " + exact(speed)).c_str());
}

}  // namespace tauext::detail
