// SPDX-License-Identifier: Apache-2.0
#include "mjcf/import/urdf.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <initializer_list>
#include <iterator>
#include <locale>
#include <set>
#include <sstream>
#include <stdexcept>
#include <string_view>
#include <utility>
#include <vector>

#include "mjcf/import/lock.h"
#include "mjcf/import/masses/inertia.h"
#include "mjcf/import/measured_terms.h"
#include "mjcf/import/schema.h"
#include "mjcf/import/xml.h"
#include "mjcf/trace/text.h"

namespace tauext::detail {
namespace {

using Eigen::Isometry3d, Eigen::Matrix3d, Eigen::Vector3d;

// numbers of an attribute, or of none
std::vector<double> numbers(const XMLElement& e, const char* attribute, std::size_t n) {
  std::vector<double> all;
  std::istringstream in(text(e, attribute));
  in.imbue(std::locale::classic());
  for (double x = 0; in >> x;) all.push_back(x);
  if (all.size() != n || !in.eof())
    fail(e, "{} of <{}> is '{}', and must be {}", attribute, name_of(e), text(e, attribute),
         n == 1 ? "a number, with a point" : fmt::format("{} numbers, with blanks between", n));
  return all;
}
double number(const XMLElement* e, const char* attribute, double otherwise) {
  if (e == nullptr || e->Attribute(attribute) == nullptr) return otherwise;
  return numbers(*e, attribute, 1).front();
}
constexpr double kEndless = 1e9;   // [rad] or [m] of a range in MJCF that has no end there
constexpr double kNoLimit = 1000;  // [rad] or [m] of a limit from which on none is meant

// of a limit; "inf" stands for none in many files, as 0 does
double bound(const XMLElement* limit, const char* attribute) {
  const std::string words = limit == nullptr ? "" : text(*limit, attribute);
  char* end = nullptr;
  const double x = std::strtod(words.c_str(), &end);
  while (std::isspace(static_cast<unsigned char>(*end)) != 0) ++end;
  return std::isinf(x) && *end == '\0' ? x : number(limit, attribute, 0);
}
Vector3d vector(const XMLElement* e, const char* attribute, const Vector3d& otherwise) {
  if (e == nullptr || e->Attribute(attribute) == nullptr) return otherwise;
  return Vector3d::Map(numbers(*e, attribute, 3).data());
}

// of <origin>: about the fixed axes x, y, z in turn
Matrix3d rotation(const XMLElement* origin) {
  const Vector3d rpy = vector(origin, "rpy", Vector3d::Zero());
  if (rpy.cwiseAbs().maxCoeff() > 4 * M_PI)
    fail(*origin,
         "rpy is {:g} {:g} {:g}, more than two turns: it is in rad, and these may be "
         "degrees",
         rpy[0], rpy[1], rpy[2]);
  return (Eigen::AngleAxisd(rpy[2], Vector3d::UnitZ()) *
          Eigen::AngleAxisd(rpy[1], Vector3d::UnitY()) *
          Eigen::AngleAxisd(rpy[0], Vector3d::UnitX()))
      .toRotationMatrix();
}

void set(XMLElement& e, const char* attribute, std::initializer_list<double> values) {
  e.SetAttribute(attribute, fmt::format("{}", fmt::join(values, " ")).c_str());
}

const KeptOfUrdf* known_of(std::string_view element) {
  const auto* const k = std::find_if(std::begin(kUrdf), std::end(kUrdf),
                                     [&](const Kept& of) { return of.element == element; });
  return k == std::end(kUrdf) ? nullptr : k;
}

// whether it says how a joint moves that does not
bool is_of_fixed(const XMLElement& e) {
  return has_word(" axis limit dynamics mimic ", name_of(e)) && parent_name(e) == "joint" &&
         text(*e.Parent()->ToElement(), "type") == "fixed";
}

// a second one would be overlooked, unless it says the same as the first
void refuse_doubles(const XMLElement& e, const std::string& owner,
                    std::map<std::string, int>& dropped) {
  for (const XMLElement* c = e.FirstChildElement(); c != nullptr; c = c->NextSiblingElement()) {
    const XMLElement* const second = c->NextSiblingElement(c->Name());
    if (second == nullptr || known_of(name_of(*c)) == nullptr) continue;
    const bool same =
        name_of(*c) == "axis" && numbers_in(text(*c, "xyz")) == numbers_in(text(*second, "xyz"));
    if (!same && !is_of_fixed(*c)) fail(*second, "{}: a second <{}>", owner, name_of(*c));
    ++dropped[fmt::format("second {}", name_of(*c))];
  }
}

// beside links and joints; what is nearly called so and has parts of them in it is misspelt
void drop_other(const XMLElement& e, std::map<std::string, int>& dropped) {
  const std::string name = in_small_letters(name_of(e));
  const bool near = std::min(edits(name, "link"), edits(name, "joint")) <= 2;
  for (const Kept& k : kUrdf) {
    if (near && e.FirstChildElement(k.element.data()) != nullptr)
      fail(e, "<{}> has a <{}>: {}", name_of(e), k.element, remedy_for(name, " link joint "));
  }
  for (const XMLElement* p = e.FirstChildElement(); p != nullptr; p = p->NextSiblingElement())
    if (const bool is_link = name_of(*p) == "link" && p->FirstChildElement() != nullptr;
        is_link || (name_of(*p) == "joint" && p->Attribute("type") != nullptr))  // no mere name
      ++dropped[fmt::format("{} in <{}>", name_of(*p), name_of(e))];
  ++dropped[std::string(name_of(e))];
}

// an attribute that is not known stands for nothing in other programs, too; but here it could be a
// known one, misspelt, or a newer way to say where something is
void drop_attribute(const XMLElement& e, const std::string& owner, std::string_view name,
                    std::string_view known, std::map<std::string, int>& dropped) {
  std::istringstream words{std::string(known)};
  for (std::string word; words >> word;) {
    const std::string small = in_small_letters(name);
    const bool like_it = edits(small, word) <= 2 || small.starts_with(word) ||  // frictionloss, too
                         name_of(e) == "axis" || name_of(e) == "mimic";
    const bool stands_for_it = e.Attribute(word.c_str()) == nullptr && like_it && !is_of_fixed(e);
    if (stands_for_it || name_of(e) == "origin")
      fail(e, "{}: <{}> knows no '{}'; known:{}", owner, name_of(e), name,
           known.substr(0, known.size() - 1));
  }
  ++dropped[fmt::format("{}.{}", name_of(e), name)];
}

// An <origin> has nothing to turn or move where it stands, unless a place beside it has none.
bool is_idle(const XMLElement& e, std::string_view within) {
  if (name_of(e) != "origin") return false;
  for (const XMLElement* beside = e.Parent()->FirstChildElement(); beside != nullptr;
       beside = beside->NextSiblingElement())
    if (has_word(within, name_of(*beside)) && beside->FirstChildElement("origin") == nullptr)
      return false;
  return true;
}

constexpr const char* kNotYet = "this is no URDF yet; run it through xacro: xacro FILE > arm.urdf";

// a value that nobody asks for says nothing
void refuse_macros(const XMLElement& at) {
  for (const XMLElement* e = at.FirstChildElement(); e != nullptr; e = e->NextSiblingElement()) {
    const bool is_value = name_of(*e) == "xacro:property" || name_of(*e) == "xacro:arg";
    if (name_of(*e).starts_with("xacro:") && !is_value) fail(*e, "<{}>: {}", name_of(*e), kNotYet);
    if (known_of(name_of(*e)) != nullptr) refuse_macros(*e);
  }
}

// typing errors would change the arm, and nobody would see it
void refuse_unknown(const XMLElement& e, const std::string& owner,
                    std::map<std::string, int>& dropped) {
  const KeptOfUrdf* const known = known_of(name_of(e));
  if (known == nullptr) {
    for (const Kept& k : kUrdf) {
      const bool stands_for_it = !has_word(kUrdfLeftOut, name_of(e)) &&
                                 edits(in_small_letters(name_of(e)), k.element) <= 2 &&
                                 e.Parent()->FirstChildElement(k.element.data()) == nullptr;
      if (stands_for_it)
        fail(e, "{}: this import knows no <{}>; did you mean '{}'? If not, take it out", owner,
             name_of(e), k.element);
    }
    ++dropped[std::string(name_of(e))];
    return;
  }
  if (!has_word(known->within, parent_name(e))) {
    if (!is_idle(e, known->within))
      fail(e, "{}: <{}> stands within <{}>, and belongs into{}", owner, name_of(e), parent_name(e),
           known->within.substr(0, known->within.size() - 1));
    ++dropped[fmt::format("{} in <{}>", name_of(e), parent_name(e))];
    return;
  }
  for (const auto* a = e.FirstAttribute(); a != nullptr; a = a->Next()) {
    const std::string_view name = a->Name();
    if (std::string_view(a->Value()).find("${") != name.npos)
      fail(e, "{}: {} is '{}': {}", owner, name, a->Value(), kNotYet);
    if (name.find(':') != name.npos) continue;
    if (!has_word(known->attributes, name))
      drop_attribute(e, owner, name, known->attributes, dropped);
  }
  refuse_doubles(e, owner, dropped);
  for (const XMLElement* c = e.FirstChildElement(); c != nullptr; c = c->NextSiblingElement())
    refuse_unknown(*c, owner, dropped);
}

// the mass of a link, or of several
struct Part {
  std::string links;
  double kg = 0;
  Vector3d center = Vector3d::Zero();   // [m] of mass
  Matrix3d inertia = Matrix3d::Zero();  // [kg m^2] about it
};

// links that are fixed to each other
struct Piece {
  std::vector<Part> parts;
  bool has_shape = false;
};

Part sum(const std::vector<Part>& parts) {
  if (parts.size() == 1) return parts.front();
  Part all;
  for (const Part& p : parts) {
    all.links += (all.links.empty() ? "" : "' with '") + p.links;
    all.kg += p.kg;
    all.center += p.kg * p.center;
  }
  if (all.kg > 0) all.center /= all.kg;
  for (const Part& p : parts) {
    const Vector3d d = p.center - all.center;
    all.inertia += p.inertia + p.kg * (d.squaredNorm() * Matrix3d::Identity() - d * d.transpose());
  }
  return all;
}

class Urdf {
 public:
  Urdf(const XMLElement& robot, XMLElement& mujoco, const UrdfReading& how)
      : mujoco_(mujoco), how_(how) {
    problems_.attempt([&] {
      read(robot);
      connect(robot);
    });
    if (!impossible_.empty())
      problems_.add(impossible_inertias(impossible_), {.lock = {}, .balance = true});
    if (!massless_.empty()) add_massless();
    problems_.raise();
  }

 private:
  void add_massless() {
    if (has_moving_mass_)
      return problems_.add(
          fmt::format("links that move and have no mass (give them an <inertial>, or --lock their "
                      "joints, or "
                      "find the masses from recordings: tauext-calibrate --masses): {}",
                      fmt::join(massless_, ", ")),
          {.lock = massless_tips_, .balance = false});
    problems_.add(fmt::format(
        "none of its links that move has a mass ({}), and dynamics needs them: take a file of the "
        "same arm that has <inertial>, write them in from the maker's data sheet, or let "
        "tauext-calibrate --masses find them in recordings",
        fmt::join(massless_, ", ")));
  }

  void read(const XMLElement& robot) {
    refuse_macros(robot);
    for (const XMLElement* e = robot.FirstChildElement(); e != nullptr; e = e->NextSiblingElement())
      problems_.attempt([&] { read_part(*e); });
    if (links_.empty()) fail(robot, "there is no link in it; is it a file of macros (xacro)?");
  }

  void read_part(const XMLElement& e) {
    const std::string_view kind = name_of(e);
    if (kind != "link" && kind != "joint") return drop_other(e, how_.dropped);
    const std::string name = text(e, "name");
    if (name.empty()) fail(e, "a {} without a name", kind);
    if (!(kind == "link" ? links_ : joint_by_name_).emplace(name, &e).second)
      fail(e, "there are two {}s '{}'", kind, name);
    if (kind == "joint") joints_.push_back(&e);
    refuse_unknown(e, fmt::format("{} '{}'", kind, name), how_.dropped);
  }

  void connect(const XMLElement& robot) {
    for (const XMLElement* j : joints_) {
      problems_.attempt([&] {
        const std::string child = link_of(*j, "child"), parent = link_of(*j, "parent");
        if (!joint_of_child_.emplace(child, j).second)
          fail(*j, "link '{}' is the child of two joints", child);
        children_[parent].push_back(j);
      });
    }
    const bool whole =
        problems_.count() == 0;  // else what follows may be for want of what was refused
    XMLElement& world = *mujoco_.InsertNewChildElement("worldbody");
    std::vector<std::string> roots;
    for (const auto& [name, link] : links_) {
      if (joint_of_child_.count(name) > 0) continue;
      roots.push_back(name);
      Piece stands;
      add_body(*link, nullptr, world, 0, stands, Isometry3d::Identity());
      for (const Part& p : stands.parts)
        if (p.kg > 0) ++how_.dropped["mass of what never moves"];
    }
    if (!whole) return;
    if (roots.size() > 1)
      fail(robot,
           "{} links are no child of a joint, and one must be: the base; join the others to it, or "
           "take them out: {}",
           roots.size(), fmt::join(roots, ", "));
    for (const auto& link : links_) problems_.attempt([&] { refuse_ring(link.first); });
    if (problems_.count() == 0) free_followers();
  }

  // Many grippers have joints that turn against their leader, and its limits: which leave no way.
  void free_followers() {
    std::map<std::string, XMLElement*> joints;
    each(mujoco_, [&](XMLElement& e) {
      if (is_joint(e)) joints.emplace(text(e, "name"), &e);
      return true;
    });
    each(mujoco_, [&](XMLElement& e) {
      if (parent_name(e) != "equality") return true;
      XMLElement& follower = *joints.at(text(e, "joint1"));
      const std::vector<double> own = numbers_in(text(follower, "range")),
                                of = numbers_in(text(*joints.at(text(e, "joint2")), "range")),
                                tie = numbers_in(text(e, "polycoef"));
      if (own.size() < 2 || of.size() < 2 || tie[1] == 0) return true;
      const auto [from, to] = std::minmax({(own[0] - tie[0]) / tie[1], (own[1] - tie[0]) / tie[1]});
      if (std::max(of[0], from) < std::min(of[1], to)) return true;
      follower.DeleteAttribute("range");
      ++how_.dropped["limits that a <mimic> contradicts"];
      return true;
    });
  }

  // what no base carries hangs on a ring, which is named once
  void refuse_ring(std::string link) {
    std::set<std::string> above;
    const auto parent = [&](const std::string& of) {
      return link_of(*joint_of_child_.at(of), "parent");
    };
    for (; placed_.count(link) == 0; link = parent(link)) {
      placed_.insert(link);
      above.insert(link);
    }
    if (above.count(link) == 0) return;
    const XMLElement& joint = *joint_of_child_.at(link);
    std::vector<std::string> joints;
    std::string at = link;
    do {
      joints.push_back(fmt::format("'{}'", text(*joint_of_child_.at(at), "name")));
      at = parent(at);
    } while (at != link);
    fail(joint, "the joints {} go round in a ring: take out one of them",
         fmt::join(joints.rbegin(), joints.rend(), ", "));
  }

  std::string link_of(const XMLElement& joint, const char* end) const {
    const XMLElement* const e = joint.FirstChildElement(end);
    std::string link = e == nullptr ? "" : text(*e, "link");
    if (links_.count(link) == 0)
      fail(joint, "joint '{}': its {} '{}' is no link; add that, or take the joint out",
           text(joint, "name"), end, link);
    return link;
  }

  // What is fixed to the link before it has its mass in the same piece, in whose frame that link
  // stands at `before`. The piece of the base never moves, and may have any inertia.
  // Returns the mass [kg] of it and of all behind it.
  double add_body(const XMLElement& link, const XMLElement* joint, XMLElement& parent, int depth,
                  Piece& piece, const Isometry3d& before) {
    const std::string name = text(link, "name");
    placed_.insert(name);
    if (depth > 90) fail(link, "more than 90 links in a row");  // XML elements, each in another
    XMLElement& body = *parent.InsertNewChildElement("body");
    body.SetAttribute("name", name == "world" ? "world_link" : name.c_str());  // MuJoCo has a world
    const bool moves = joint != nullptr && text(*joint, "type") != "fixed" &&
                       !is_locked(text(*joint, "name"), how_.lock);
    Isometry3d frame = Isometry3d::Identity();
    problems_.attempt([&] {
      if (joint == nullptr) return;
      if (text(*joint, "type") != "fixed") add_joint(*joint, moves, body);
      const XMLElement* const origin = joint->FirstChildElement("origin");
      frame.linear() = rotation(origin);
      frame.translation() = vector(origin, "xyz", Vector3d::Zero());
      const Vector3d at = frame.translation();
      const Eigen::Quaterniond q(frame.linear());
      set(body, "pos", {at[0], at[1], at[2]});
      set(body, "quat", {q.w(), q.x(), q.y(), q.z()});
    });
    Piece own;
    Piece& all = moves ? own : piece;
    const Isometry3d here = moves ? Isometry3d::Identity() : before * frame;
    const std::size_t parts_before = all.parts.size();
    if (!problems_.attempt([&] { add_part(link, here, all.parts); }))
      all.parts.push_back({name, 1, here.translation(), Matrix3d::Identity()});
    for (const char* shape : {"visual", "collision"})
      all.has_shape = all.has_shape || link.FirstChildElement(shape) != nullptr;
    const double kg = all.parts.size() > parts_before ? all.parts.back().kg : 0;
    double behind = 0;
    for (const XMLElement* j : children_[name])
      behind += add_body(*links_.at(link_of(*j, "child")), j, body, depth + 1, all, here);
    if (moves) add_inertial(link, text(*joint, "name"), own, behind, body);
    return kg + behind;
  }

  static void add_part(const XMLElement& link, const Isometry3d& at, std::vector<Part>& parts) {
    const XMLElement* const inertial = link.FirstChildElement("inertial");
    if (inertial == nullptr) return;
    const XMLElement* const origin = inertial->FirstChildElement("origin");
    const XMLElement* const mass = inertial->FirstChildElement("mass");
    const XMLElement* const tensor = inertial->FirstChildElement("inertia");
    if (mass == nullptr || tensor == nullptr)
      fail(*inertial, "link '{}': its <inertial> wants a <mass> and an <inertia>",
           text(link, "name"));
    const double kg = numbers(*mass, "value", 1).front();
    if (!(kg >= 0))
      fail(*mass, "link '{}': its mass is {:g} kg, and must be 0 or more", text(link, "name"), kg);
    const auto of = [&](const char* which) { return number(tensor, which, 0); };
    Matrix3d I;
    I << of("ixx"), of("ixy"), of("ixz"), of("ixy"), of("iyy"), of("iyz"), of("ixz"), of("iyz"),
        of("izz");
    if (kg == 0 && I.isZero(0)) return;
    const Matrix3d R = at.linear() * rotation(origin);
    parts.push_back({text(link, "name"), kg, at * vector(origin, "xyz", Vector3d::Zero()),
                     Matrix3d(R * I * R.transpose())});
  }

  // A frame between two joints, as those that a ball joint is made of have between them, needs no
  // mass; MuJoCo wants some.
  void add_inertial(const XMLElement& link, const std::string& joint, const Piece& piece,
                    double behind, XMLElement& body) {
    constexpr double kNearlyNone = 1e-12;  // [kg], [kg m^2]
    if (how_.bodies.count(text(link, "name")) > 0) {
      has_moving_mass_ = true;
      return;
    }
    Part p = sum(piece.parts);
    has_moving_mass_ = has_moving_mass_ || p.kg > 0;
    if (p.kg == 0 && behind > 0 && !piece.has_shape) {
      p.kg = kNearlyNone;
      p.inertia = kNearlyNone * Matrix3d::Identity();
      ++how_.changed["frame between joints that has no mass, now 1e-12 kg"];
    }
    if (p.kg == 0 && how_.masses_unknown) return;
    if (p.kg == 0) {
      if (behind == 0) massless_tips_.insert(joint);  // which is nothing to the rest of the arm
      return massless_.push_back(fmt::format("'{}' ({})", text(link, "name"), place_of(link)));
    }
    const MendedInertia m = mended(p.inertia, p.kg);
    if (!m.few_digits && !how_.balance)
      impossible_.push_back(impossible(p.links, place_of(link), m.moments));
    if (m.change > 1e-8)
      ++how_.changed[fmt::format("inertia of '{}' by {:.2g} %", p.links, 100 * m.change)];
    XMLElement& out = *body.InsertNewChildElement("inertial");
    set(out, "pos", {p.center[0], p.center[1], p.center[2]});
    set(out, "mass", {p.kg});
    // MuJoCo finds the axes of a "fullinertia" to seven digits
    set(out, "quat", {m.axes.w(), m.axes.x(), m.axes.y(), m.axes.z()});
    set(out, "diaginertia", {m.principal[0], m.principal[1], m.principal[2]});
  }

  void add_joint(const XMLElement& joint, bool moves, XMLElement& body) {
    const std::string type = text(joint, "type"), name = text(joint, "name");
    const bool slide = type == "prismatic";
    XMLElement& out = *body.InsertNewChildElement("joint");
    out.SetAttribute("name", name.c_str());
    out.SetAttribute("type", slide ? "slide" : "hinge");
    if (!slide && type != "revolute" && type != "continuous") {
      if (!moves) return;  // it is locked
      const std::string words = at_line(
          joint,
          "joint '{}' is {}: revolute, continuous, prismatic and fixed are known; --lock REGEX "
          "fixes others",
          name, type);
      for (const char* const known : {"revolute", "continuous", "prismatic", "fixed"})
        if (type.empty() || edits(type, known) <= 2) throw std::runtime_error(words);  // misspelt
      throw Mendable(words, {.lock = {name}, .balance = false});
    }
    problems_.attempt([&] { set_axis(joint, out); });
    problems_.attempt([&] { set_range(joint, out); });
    const XMLElement* const dynamics = joint.FirstChildElement("dynamics");
    const auto copy = [&](const char* term, const char* attribute) {
      const double x = number(dynamics, term, 0);
      if (!(x >= 0))
        fail(*dynamics, "joint '{}': its {} is {:g}, and must be 0 or more", name, term, x);
      set(out, attribute, {x});
    };
    problems_.attempt([&] {
      if (const double k = number(dynamics, "spring_stiffness", 0); k != 0)
        fail(*dynamics,
             "joint '{}' has a spring (spring_stiffness {:g}), which is not known: take "
             "it out of the file if the arm has none",
             name, k);
    });
    problems_.attempt([&] { copy("damping", "damping"); });
    problems_.attempt([&] { copy("friction", "frictionloss"); });
    problems_.attempt([&] { copy("armature", "armature"); });  // URDF itself has no word for it
    const XMLElement* const limit = joint.FirstChildElement("limit");
    problems_.attempt(
        [&] { put_rated(mujoco_, name, bound(limit, "effort"), bound(limit, "velocity")); });
    problems_.attempt([&] { tie(joint, moves); });
  }

  static void set_axis(const XMLElement& joint, XMLElement& out) {
    const Vector3d axis = vector(joint.FirstChildElement("axis"), "xyz", Vector3d::UnitX());
    if (!(axis.norm() > 1e-9))
      fail(joint, "joint '{}': its axis has no direction", text(joint, "name"));
    set(out, "axis", {axis[0], axis[1], axis[2]});
  }

  void set_range(const XMLElement& joint, XMLElement& out) {
    const std::string type = text(joint, "type"), name = text(joint, "name");
    const XMLElement* const limit = joint.FirstChildElement("limit");
    const double lower = bound(limit, "lower"), upper = bound(limit, "upper");
    if (lower == 0 && upper == 0) {
      if (limit != nullptr && type != "continuous" && limit->Attribute("lower") != nullptr)
        ++how_.dropped["limits of 0 and 0"];
      return;
    }
    if (type == "continuous") {
      ++how_.dropped["limits of a continuous joint"];
      return;
    }
    if (!(lower < upper))
      fail(joint,
           "joint '{}' has no way to go from {} to {}: correct lower or upper, or make it fixed",
           name, lower, upper);
    const bool from = lower > -kNoLimit, to = upper < kNoLimit;
    if (!from) ++how_.dropped["endless limit"];
    if (!to) ++how_.dropped["endless limit"];
    if (!from && !to) return;
    if (type == "revolute" && std::max(from ? -lower : 0, to ? upper : 0) > 20)
      fail(joint, "joint '{}' goes from {} to {} rad: give radians, or make it continuous", name,
           lower, upper);
    set(out, "range", {from ? lower : -kEndless, to ? upper : kEndless});
  }

  void tie(const XMLElement& joint, bool moves) {
    const XMLElement* const mimic = joint.FirstChildElement("mimic");
    if (mimic == nullptr) return;
    const std::string name = text(joint, "name"), leader = text(*mimic, "joint");
    if (!can_lead(leader, name)) {
      if (!moves) return;  // it is locked
      throw Mendable(at_line(*mimic,
                             "joint '{}': its <mimic> follows '{}', which is no other joint that "
                             "moves",
                             name, leader),
                     {.lock = {name}, .balance = false});
    }
    const double offset = number(mimic, "offset", 0), multiplier = number(mimic, "multiplier", 1);
    XMLElement& e = *mujoco_.InsertNewChildElement("equality")->InsertNewChildElement("joint");
    e.SetAttribute("joint1", name.c_str());
    e.SetAttribute("joint2", leader.c_str());
    set(e, "polycoef", {offset, multiplier, 0, 0, 0});
  }

  // it moves, and is another one
  bool can_lead(const std::string& leader, const std::string& follower) const {
    const auto found = joint_by_name_.find(leader);
    return leader != follower && found != joint_by_name_.end() &&
           text(*found->second, "type") != "fixed";
  }

  XMLElement& mujoco_;
  const UrdfReading& how_;
  Problems problems_;
  std::vector<std::string> impossible_, massless_;
  std::set<std::string> massless_tips_;  // joints that carry such links, with no mass behind
  bool has_moving_mass_ = false;
  std::map<std::string, const XMLElement*> links_, joint_by_name_, joint_of_child_;
  std::map<std::string, std::vector<const XMLElement*>> children_;
  std::vector<const XMLElement*> joints_;
  std::set<std::string> placed_;
};

}  // namespace

void urdf_to_mjcf(const XMLElement& robot, tinyxml2::XMLDocument& mjcf, const UrdfReading& how) {
  mjcf.Clear();
  XMLElement* const mujoco = mjcf.NewElement("mujoco");
  mjcf.InsertEndChild(mujoco);
  mujoco->InsertNewChildElement("compiler")->SetAttribute("angle", "radian");
  Urdf(robot, *mujoco, how);
}

}  // namespace tauext::detail
