// SPDX-License-Identifier: Apache-2.0
#include "mjcf/import/urdf.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <iterator>
#include <locale>
#include <set>
#include <sstream>
#include <string_view>
#include <utility>
#include <vector>

#include "mjcf/import/measured_terms.h"
#include "mjcf/import/schema.h"
#include "mjcf/import/xml.h"

namespace tauext::detail {
namespace {

using Eigen::Matrix3d, Eigen::Vector3d;

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
Vector3d vector(const XMLElement* e, const char* attribute, const Vector3d& otherwise) {
  if (e == nullptr || e->Attribute(attribute) == nullptr) return otherwise;
  return Vector3d::Map(numbers(*e, attribute, 3).data());
}

// of <origin>: about the fixed axes x, y, z in turn
Matrix3d rotation(const XMLElement* origin) {
  const Vector3d rpy = vector(origin, "rpy", Vector3d::Zero());
  return (Eigen::AngleAxisd(rpy[2], Vector3d::UnitZ()) *
          Eigen::AngleAxisd(rpy[1], Vector3d::UnitY()) *
          Eigen::AngleAxisd(rpy[0], Vector3d::UnitX()))
      .toRotationMatrix();
}

void set(XMLElement& e, const char* attribute, std::initializer_list<double> values) {
  e.SetAttribute(attribute, fmt::format("{}", fmt::join(values, " ")).c_str());
}

bool is_known(std::string_view element) {
  return std::any_of(std::begin(kUrdf), std::end(kUrdf),
                     [&](const Kept& k) { return k.element == element; });
}

// a second one would be overlooked
void refuse_doubles(const XMLElement& e, const std::string& owner) {
  for (const XMLElement* c = e.FirstChildElement(); c != nullptr; c = c->NextSiblingElement())
    if (const XMLElement* const second = c->NextSiblingElement(c->Name());
        second != nullptr && is_known(name_of(*c)))
      fail(*second, "{}: a second <{}>", owner, name_of(*c));
}

// beside links and joints; what is nearly called so and has parts of them in it is misspelt
void drop_other(const XMLElement& e, std::map<std::string, int>& dropped) {
  const bool near = std::min(edits(name_of(e), "link"), edits(name_of(e), "joint")) <= 2;
  for (const Kept& k : kUrdf) {
    if (near && e.FirstChildElement(std::string(k.element).c_str()) != nullptr)
      fail(e, "<{}> has a <{}>: {}", name_of(e), k.element, remedy_for(name_of(e), " link joint "));
  }
  ++dropped[std::string(name_of(e))];
}

// an attribute that is not known stands for nothing in other programs, too; but here it could be a
// known one, misspelt, or a newer way to say where something is
void drop_attribute(const XMLElement& e, const std::string& owner, std::string_view name,
                    std::string_view known, std::map<std::string, int>& dropped) {
  std::istringstream words{std::string(known)};
  for (std::string word; words >> word;) {
    const bool like_it = edits(name, word) <= 2 || name.starts_with(word);  // frictionloss, too
    const bool stands_for_it = e.Attribute(word.c_str()) == nullptr && like_it;
    if (stands_for_it || name_of(e) == "origin")
      fail(e, "{}: <{}> knows no '{}'; known:{}", owner, name_of(e), name,
           known.substr(0, known.size() - 1));
  }
  ++dropped[fmt::format("{}.{}", name_of(e), name)];
}

// typing errors would change the arm, and nobody would see it
void refuse_unknown(const XMLElement& e, const std::string& owner,
                    std::map<std::string, int>& dropped) {
  const auto known = std::find_if(std::begin(kUrdf), std::end(kUrdf),
                                  [&](const Kept& k) { return k.element == name_of(e); });
  if (known == std::end(kUrdf)) {
    const bool other = name_of(e).find(':') != std::string_view::npos;
    if (!other && !has_word(kUrdfLeftOut, name_of(e)))
      fail(e, "{}: this import knows no <{}>; {}", owner, name_of(e),
           remedy_for(name_of(e), elements_of(kUrdf)));
    ++dropped[std::string(name_of(e))];
    return;
  }
  for (const auto* a = e.FirstAttribute(); a != nullptr; a = a->Next()) {
    const std::string_view name = a->Name();
    if (name.find(':') != name.npos) continue;
    if (!has_word(known->attributes, name))
      drop_attribute(e, owner, name, known->attributes, dropped);
  }
  refuse_doubles(e, owner);
  for (const XMLElement* c = e.FirstChildElement(); c != nullptr; c = c->NextSiblingElement())
    refuse_unknown(*c, owner, dropped);
}

// [kg m^2] about the center of mass: that of a body
void check_inertia(const XMLElement& link, const Matrix3d& I) {
  const Vector3d moments = Eigen::SelfAdjointEigenSolver<Matrix3d>(I).eigenvalues();
  if (moments[0] > 0 && moments[0] + moments[1] >= (1 - 1e-9) * moments[2]) return;
  fail(link,
       "link '{}': its principal moments of inertia are {:.4g}, {:.4g} and {:.4g} kg m^2; no body "
       "has these: each is above 0 and at most the sum of the others",
       text(link, "name"), moments[0], moments[1], moments[2]);
}

class Urdf {
 public:
  Urdf(const XMLElement& robot, XMLElement& mujoco, std::map<std::string, int>& dropped)
      : mujoco_(mujoco), dropped_(dropped) {
    for (const XMLElement* e = robot.FirstChildElement(); e != nullptr;
         e = e->NextSiblingElement()) {
      const std::string_view kind = name_of(*e);
      if (kind.starts_with("xacro:"))
        fail(*e, "<{}>: this is no URDF yet; run it through xacro", kind);
      if ((kind == "link" || kind == "joint") && text(*e, "name").empty())
        fail(*e, "a {} without a name", kind);
      if (kind == "link") {
        if (!links_.emplace(text(*e, "name"), e).second)
          fail(*e, "there are two links '{}'", text(*e, "name"));
        refuse_unknown(*e, fmt::format("link '{}'", text(*e, "name")), dropped);
      } else if (kind == "joint") {
        for (const XMLElement* j : joints_)
          if (text(*j, "name") == text(*e, "name"))
            fail(*e, "there are two joints '{}'", text(*e, "name"));
        refuse_unknown(*e, fmt::format("joint '{}'", text(*e, "name")), dropped);
        joints_.push_back(e);
      } else {
        drop_other(*e, dropped);
      }
    }
    for (const XMLElement* j : joints_) {
      const std::string child = link_of(*j, "child"), parent = link_of(*j, "parent");
      if (!joint_of_child_.emplace(child, j).second)
        fail(*j, "link '{}' is the child of two joints", child);
      children_[parent].push_back(j);
    }
    XMLElement& world = *mujoco.InsertNewChildElement("worldbody");
    int roots = 0;
    for (const auto& [name, link] : links_) {
      if (joint_of_child_.count(name) > 0) continue;
      ++roots;
      add_body(*link, nullptr, world, 0);
    }
    if (roots == 0) fail(robot, "every link is a joint's child: the joints go round in a ring");
    if (roots != 1)
      fail(robot, "{} links are no child of a joint, and one must be: the base", roots);
    for (const auto& [name, link] : links_)
      if (placed_.count(name) == 0) fail(*link, "link '{}' hangs on itself", name);
  }

 private:
  std::string link_of(const XMLElement& joint, const char* end) const {
    const XMLElement* const e = joint.FirstChildElement(end);
    std::string link = e == nullptr ? "" : text(*e, "link");
    if (links_.count(link) == 0)
      fail(joint, "joint '{}': its {} '{}' is no link", text(joint, "name"), end, link);
    return link;
  }

  void add_body(const XMLElement& link, const XMLElement* joint, XMLElement& parent, int depth) {
    placed_.insert(text(link, "name"));
    if (depth > 200) fail(link, "more than 200 links in a row");
    XMLElement& body = *parent.InsertNewChildElement("body");
    const std::string name = text(link, "name");
    body.SetAttribute("name", name == "world" ? "world_link" : name.c_str());  // MuJoCo has a world
    if (joint != nullptr) {
      const XMLElement* const origin = joint->FirstChildElement("origin");
      const Vector3d at = vector(origin, "xyz", Vector3d::Zero());
      const Eigen::Quaterniond q(rotation(origin));
      set(body, "pos", {at[0], at[1], at[2]});
      set(body, "quat", {q.w(), q.x(), q.y(), q.z()});
    }
    add_inertial(link, body);
    if (joint != nullptr) add_joint(*joint, body);
    for (const XMLElement* j : children_[text(link, "name")])
      add_body(*links_.at(link_of(*j, "child")), j, body, depth + 1);
  }

  static void add_inertial(const XMLElement& link, XMLElement& body) {
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
    check_inertia(link, I);
    const Matrix3d R = rotation(origin);
    I = R * I * R.transpose();
    const Vector3d at = vector(origin, "xyz", Vector3d::Zero());
    XMLElement& out = *body.InsertNewChildElement("inertial");
    set(out, "pos", {at[0], at[1], at[2]});
    set(out, "mass", {kg});
    set(out, "fullinertia", {I(0, 0), I(1, 1), I(2, 2), I(0, 1), I(0, 2), I(1, 2)});
  }

  static void check_range(const XMLElement& joint, double lower, double upper) {
    if (!(lower < upper))
      fail(joint,
           "joint '{}' has no way to go from {} to {}: correct lower or upper, or make it fixed",
           text(joint, "name"), lower, upper);
    if (text(joint, "type") == "revolute" && std::max(-lower, upper) > 20)
      fail(joint, "joint '{}' goes from {} to {} rad: give radians, or make it continuous",
           text(joint, "name"), lower, upper);
  }

  void add_joint(const XMLElement& joint, XMLElement& body) {
    const std::string type = text(joint, "type"), name = text(joint, "name");
    if (type == "fixed") return;
    const bool slide = type == "prismatic";
    if (!slide && type != "revolute" && type != "continuous")
      fail(joint, "joint '{}' is {}: revolute, continuous, prismatic and fixed are known", name,
           type);
    XMLElement& out = *body.InsertNewChildElement("joint");
    out.SetAttribute("name", name.c_str());
    out.SetAttribute("type", slide ? "slide" : "hinge");
    const Vector3d axis = vector(joint.FirstChildElement("axis"), "xyz", Vector3d::UnitX());
    if (!(axis.norm() > 1e-9)) fail(joint, "joint '{}': its axis has no direction", name);
    set(out, "axis", {axis[0], axis[1], axis[2]});
    const XMLElement* const limit = joint.FirstChildElement("limit");
    const double lower = number(limit, "lower", 0), upper = number(limit, "upper", 0);
    const bool has_range = type != "continuous" && (lower != 0 || upper != 0) &&
                           std::max(-lower, upper) < 1000;  // beyond that it stands for none
    if (has_range) {
      check_range(joint, lower, upper);
      set(out, "range", {lower, upper});
    } else if (type != "continuous") {
      ++dropped_["joint without a range"];
    }
    const XMLElement* const dynamics = joint.FirstChildElement("dynamics");
    for (const char* term : {"damping", "friction", "armature"}) {
      if (const double x = number(dynamics, term, 0); !(x >= 0))
        fail(*dynamics, "joint '{}': its {} is {:g}, and must be 0 or more", name, term, x);
    }
    set(out, "damping", {number(dynamics, "damping", 0)});
    set(out, "frictionloss", {number(dynamics, "friction", 0)});
    set(out, "armature", {number(dynamics, "armature", 0)});  // URDF itself has no word for it
    if (limit != nullptr) put_rated_torque(mujoco_, name, limit->DoubleAttribute("effort"));
    if (const XMLElement* const mimic = joint.FirstChildElement("mimic")) {
      XMLElement& tie = *mujoco_.InsertNewChildElement("equality")->InsertNewChildElement("joint");
      tie.SetAttribute("joint1", name.c_str());
      tie.SetAttribute("joint2", leader_of(*mimic, name).c_str());
      set(tie, "polycoef", {number(mimic, "offset", 0), number(mimic, "multiplier", 1), 0, 0, 0});
    }
  }

  // that moves, and is another one
  std::string leader_of(const XMLElement& mimic, const std::string& follower) const {
    std::string leader = text(mimic, "joint");
    for (const XMLElement* j : joints_) {
      if (leader != follower && text(*j, "name") == leader && text(*j, "type") != "fixed")
        return leader;
    }
    fail(mimic, "joint '{}': its <mimic> follows '{}', which is no other joint that moves",
         follower, leader);
  }

  XMLElement& mujoco_;
  std::map<std::string, int>& dropped_;
  std::map<std::string, const XMLElement*> links_, joint_of_child_;
  std::map<std::string, std::vector<const XMLElement*>> children_;
  std::vector<const XMLElement*> joints_;
  std::set<std::string> placed_;
};

}  // namespace

void urdf_to_mjcf(const XMLElement& robot, tinyxml2::XMLDocument& mjcf,
                  std::map<std::string, int>& dropped) {
  mjcf.Clear();
  XMLElement* const mujoco = mjcf.NewElement("mujoco");
  mjcf.InsertEndChild(mujoco);
  mujoco->InsertNewChildElement("compiler")->SetAttribute("angle", "radian");
  Urdf(robot, *mujoco, dropped);
}

}  // namespace tauext::detail
