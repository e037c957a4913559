// SPDX-License-Identifier: Apache-2.0
#include "mjcf/import/masses/body_masses.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cstdlib>
#include <stdexcept>
#include <vector>

#include "mjcf/import/masses/inertia.h"
#include "mjcf/import/xml.h"
#include "mjcf/trace/known.h"

namespace tauext::detail {
namespace {

// calls visit(element) for what is in a body, and in those that are fixed to it
template <class Visit>
void each_part(XMLElement& body, Visit&& visit) {
  for (XMLElement* e = body.FirstChildElement(); e != nullptr;) {
    XMLElement* const next = e->NextSiblingElement();
    if (name_of(*e) != "body") {
      visit(*e);
    } else if (!has_joint(*e)) {
      each_part(*e, visit);
    }
    e = next;
  }
}

template <class Visit>
void each_moving(XMLElement& mujoco, Visit&& visit) {
  each(mujoco, [&](XMLElement& e) {
    if (name_of(e) == "body" && has_joint(e)) visit(e);
    return true;
  });
}

void refuse_other_masses(XMLElement& mujoco) {
  each(mujoco, [&](const XMLElement& e) {
    if (name_of(e) != "compiler") return true;
    if (text(e, "inertiafromgeom") == "true" || e.DoubleAttribute("settotalmass", 0) > 0)
      fail(e,
           "<compiler> has inertiafromgeom=\"true\" or settotalmass, which overrule the masses of "
           "\"bodies\": take that out");
    return true;
  });
}

void remove_masses(XMLElement& body) {
  each_part(body, [](XMLElement& e) {
    if (name_of(e) == "geom") e.SetAttribute("mass", "0");
    if (name_of(e) == "inertial") e.Parent()->DeleteChild(&e);
  });
}

// a shape has one by its class, too, or none
bool has_mass(XMLElement& mujoco, XMLElement& body) {
  bool any = false;
  const auto is_none = [&](const XMLElement& e, const char* attribute) {
    const std::string value = with_defaults(mujoco, e, attribute);
    return !value.empty() && !(std::strtod(value.c_str(), nullptr) > 0);
  };
  each_part(body, [&](const XMLElement& e) {
    if (name_of(e) == "inertial") any = any || e.DoubleAttribute("mass", 1) > 0;
    if (name_of(e) != "geom" || is_none(e, "mass")) return;
    any = any || !with_defaults(mujoco, e, "mass").empty() || !is_none(e, "density");
  });
  return any;
}

void put_inertial(XMLElement& body, const MeasuredBody& b) {
  const MendedInertia m = mended(tensor(b), b.mass);
  XMLElement& e = *body.InsertNewChildElement("inertial");
  const auto put = [&](const char* attribute, std::vector<double> values) {
    e.SetAttribute(attribute, fmt::format("{:.17g}", fmt::join(values, " ")).c_str());
  };
  put("mass", {b.mass});
  put("pos", {b.center[0], b.center[1], b.center[2]});
  // MuJoCo finds the axes of a "fullinertia" to seven digits
  put("quat", {m.axes.w(), m.axes.x(), m.axes.y(), m.axes.z()});
  put("diaginertia", {m.principal[0], m.principal[1], m.principal[2]});
}

}  // namespace

Eigen::Matrix3d tensor(const MeasuredBody& b) {
  const double* const I = b.inertia;
  Eigen::Matrix3d M;
  M << I[0], I[3], I[4], I[3], I[1], I[5], I[4], I[5], I[2];
  return M;
}

void put_bodies(XMLElement& mujoco, const std::map<std::string, MeasuredBody>& bodies) {
  if (bodies.empty()) return;
  refuse_other_masses(mujoco);
  std::map<std::string, XMLElement*> moving;
  each_moving(mujoco, [&](XMLElement& e) { moving.emplace(text(e, "name"), &e); });
  std::vector<std::string> names;
  for (const auto& [name, element] : moving)
    if (!name.empty()) names.push_back(name);
  for (const auto& [name, body] : bodies) {
    const auto at = moving.find(name);
    if (at == moving.end())
      throw std::runtime_error(unknown("body with a joint", name, names).what());
    remove_masses(*at->second);
    put_inertial(*at->second, body);
  }
}

std::set<std::string> fill_masses(XMLElement& mujoco) {
  std::set<std::string> filled;
  each_moving(mujoco, [&](XMLElement& e) {
    if (has_mass(mujoco, e)) return;
    if (text(e, "name").empty())
      fail(e, "a body that moves has no mass and no name: give it a name");
    remove_masses(e);
    put_inertial(e, {1, {0, 0, 0}, {0.01, 0.01, 0.01, 0, 0, 0}});
    filled.insert(text(e, "name"));
  });
  return filled;
}

}  // namespace tauext::detail
