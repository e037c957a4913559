// SPDX-License-Identifier: Apache-2.0
#include "mjcf/import/urdf.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Eigenvalues>
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
#include "mjcf/import/measured_terms.h"
#include "mjcf/import/schema.h"
#include "mjcf/import/xml.h"

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

std::string in_small_letters(std::string_view name) {
  std::string small(name);
  for (char& c : small) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return small;
}

// a second one would be overlooked
void refuse_doubles(const XMLElement& e, const std::string& owner) {
  for (const XMLElement* c = e.FirstChildElement(); c != nullptr; c = c->NextSiblingElement())
    if (const XMLElement* const second = c->NextSiblingElement(c->Name());
        second != nullptr && known_of(name_of(*c)) != nullptr)
      fail(*second, "{}: a second <{}>", owner, name_of(*c));
}

// beside links and joints; what is nearly called so and has parts of them in it is misspelt, and
// what has a link with a mass in it would lose that
void drop_other(const XMLElement& e, std::map<std::string, int>& dropped) {
  const std::string name = in_small_letters(name_of(e));
  const bool near = std::min(edits(name, "link"), edits(name, "joint")) <= 2;
  for (const Kept& k : kUrdf) {
    if (near && e.FirstChildElement(k.element.data()) != nullptr)
      fail(e, "<{}> has a <{}>: {}", name_of(e), k.element, remedy_for(name, " link joint "));
  }
  for (const XMLElement* l = e.FirstChildElement("link"); l != nullptr;
       l = l->NextSiblingElement("link")) {
    if (l->FirstChildElement("inertial") != nullptr)
      fail(*l, "link '{}' stands within <{}>, and belongs into <robot>", text(*l, "name"),
           name_of(e));
  }
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
  if (name_of(e).starts_with("xacro:"))
    fail(e, "{}: <{}>: this is no URDF yet; run it through xacro", owner, name_of(e));
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
  if (!has_word(known->within, parent_name(e)))
    fail(e, "{}: <{}> stands within <{}>, and belongs into{}", owner, name_of(e), parent_name(e),
         known->within.substr(0, known->within.size() - 1));
  for (const auto* a = e.FirstAttribute(); a != nullptr; a = a->Next()) {
    const std::string_view name = a->Name();
    if (std::string_view(a->Value()).find("${") != name.npos)
      fail(e, "{}: {} is '{}': this is no URDF yet; run it through xacro", owner, name, a->Value());
    if (name.find(':') != name.npos) continue;
    if (!has_word(known->attributes, name))
      drop_attribute(e, owner, name, known->attributes, dropped);
  }
  refuse_doubles(e, owner);
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

// The nearest principal moments that a body has, a little within: each is above 0, and at most the
// sum of the others. Those of a ball of water's density if there are none at all.
Vector3d balanced(const Vector3d& moments, double kg) {  // the least first
  const double r = std::cbrt(kg / 4189), most = moments[2];
  Vector3d m = moments.cwiseMax(most > 0 ? 1e-6 * most : .4 * kg * r * r);
  if (const double missing = m[2] - m[0] - m[1] + 1e-9 * most; missing > 0)
    m += missing / 3 * Vector3d(1, 1, -1);
  return m;
}

// whether what is missing was lost where the file was printed with few digits
bool can_be(const Vector3d& moments) {
  const double missing = std::max(-moments[0], moments[2] - moments[0] - moments[1]);
  return moments[2] > 0 && missing <= 1e-3 * moments[2];
}

class Urdf {
 public:
  Urdf(const XMLElement& robot, XMLElement& mujoco, const UrdfReading& how)
      : mujoco_(mujoco), how_(how) {
    attempt([&] {
      read(robot);
      connect(robot);
    });
    if (!impossible_.empty())
      problems_.push_back(fmt::format(
          "{} principal moments of inertia [kg m^2] that no body has (each is above 0, and at most "
          "the sum of the others; tauext-import --balance mends them): {}",
          impossible_.size() == 1 ? "a link has" : fmt::format("{} links have", impossible_.size()),
          fmt::join(impossible_, ", ")));
    if (!massless_.empty())
      problems_.push_back(fmt::format(
          "links that move and have no mass (give them an <inertial>, or --lock their joints): {}",
          fmt::join(massless_, ", ")));
    if (!problems_.empty())
      throw std::runtime_error(one_line(fmt::format("{}", fmt::join(problems_, "; ")), 8000));
  }

 private:
  // every error of a file in one message
  template <class Try>
  void attempt(Try&& what) {
    try {
      what();
    } catch (const std::runtime_error& e) {
      problems_.emplace_back(e.what());
    }
  }

  void read(const XMLElement& robot) {
    for (const XMLElement* e = robot.FirstChildElement(); e != nullptr; e = e->NextSiblingElement())
      attempt([&] { read_part(*e); });
    if (links_.empty()) fail(robot, "there is no link in it; is it a file of macros (xacro)?");
  }

  void read_part(const XMLElement& e) {
    const std::string_view kind = name_of(e);
    if (kind.starts_with("xacro:"))
      fail(e, "<{}>: this is no URDF yet; run it through xacro", kind);
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
      attempt([&] {
        const std::string child = link_of(*j, "child"), parent = link_of(*j, "parent");
        if (!joint_of_child_.emplace(child, j).second)
          fail(*j, "link '{}' is the child of two joints", child);
        children_[parent].push_back(j);
      });
    }
    const bool whole = problems_.empty();  // else what follows may be for want of what was refused
    XMLElement& world = *mujoco_.InsertNewChildElement("worldbody");
    int roots = 0;
    for (const auto& [name, link] : links_) {
      if (joint_of_child_.count(name) > 0) continue;
      ++roots;
      std::vector<Part> stands;
      add_body(*link, nullptr, world, 0, stands, Isometry3d::Identity());
    }
    if (!whole) return;
    if (roots == 0) fail(robot, "every link is a joint's child: the joints go round in a ring");
    if (roots != 1)
      fail(robot, "{} links are no child of a joint, and one must be: the base", roots);
    for (const auto& [name, link] : links_)
      if (placed_.count(name) == 0) fail(*link, "link '{}' hangs on itself", name);
  }

  std::string link_of(const XMLElement& joint, const char* end) const {
    const XMLElement* const e = joint.FirstChildElement(end);
    std::string link = e == nullptr ? "" : text(*e, "link");
    if (links_.count(link) == 0)
      fail(joint, "joint '{}': its {} '{}' is no link", text(joint, "name"), end, link);
    return link;
  }

  // What is fixed to the link before it has its mass in the same piece, in whose frame that link
  // stands at `before`. The piece of the base never moves, and may have any inertia.
  void add_body(const XMLElement& link, const XMLElement* joint, XMLElement& parent, int depth,
                std::vector<Part>& piece, const Isometry3d& before) {
    const std::string name = text(link, "name");
    placed_.insert(name);
    if (depth > 90) fail(link, "more than 90 links in a row");  // XML elements, each in another
    XMLElement& body = *parent.InsertNewChildElement("body");
    body.SetAttribute("name", name == "world" ? "world_link" : name.c_str());  // MuJoCo has a world
    const bool moves = joint != nullptr && text(*joint, "type") != "fixed" &&
                       !is_locked(text(*joint, "name"), how_.lock);
    Isometry3d frame = Isometry3d::Identity();
    attempt([&] {
      if (joint == nullptr) return;
      const XMLElement* const origin = joint->FirstChildElement("origin");
      frame.linear() = rotation(origin);
      frame.translation() = vector(origin, "xyz", Vector3d::Zero());
      const Vector3d at = frame.translation();
      const Eigen::Quaterniond q(frame.linear());
      set(body, "pos", {at[0], at[1], at[2]});
      set(body, "quat", {q.w(), q.x(), q.y(), q.z()});
      if (text(*joint, "type") != "fixed") add_joint(*joint, body);
    });
    std::vector<Part> own;
    std::vector<Part>& parts = moves ? own : piece;
    const Isometry3d here = moves ? Isometry3d::Identity() : before * frame;
    const std::size_t before_it = problems_.size();
    attempt([&] { add_part(link, here, parts); });
    if (problems_.size() > before_it)
      parts.push_back({name, 1, here.translation(), Matrix3d::Identity()});
    for (const XMLElement* j : children_[name])
      add_body(*links_.at(link_of(*j, "child")), j, body, depth + 1, parts, here);
    if (moves) add_inertial(link, sum(own), body);
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

  void add_inertial(const XMLElement& link, Part p, XMLElement& body) {
    if (p.kg == 0)
      return massless_.push_back(
          fmt::format("'{}' (line {})", text(link, "name"), link.GetLineNum()));
    const Eigen::SelfAdjointEigenSolver<Matrix3d> axes(p.inertia);
    const Vector3d& moments = axes.eigenvalues();
    const Vector3d mended = balanced(moments, p.kg);
    const double change = (mended - moments).cwiseAbs().maxCoeff() / mended[2];
    if (!can_be(moments) && !how_.balance)
      impossible_.push_back(fmt::format("'{}' (line {}) {:.4g}, {:.4g} and {:.4g}", p.links,
                                        link.GetLineNum(), moments[0], moments[1], moments[2]));
    if (change > 0)
      p.inertia = axes.eigenvectors() * mended.asDiagonal() * axes.eigenvectors().transpose();
    if (change > 1e-8)
      ++how_.changed[fmt::format("inertia of '{}' by {:.2g} %", p.links, 100 * change)];
    XMLElement& out = *body.InsertNewChildElement("inertial");
    const Matrix3d& I = p.inertia;
    set(out, "pos", {p.center[0], p.center[1], p.center[2]});
    set(out, "mass", {p.kg});
    set(out, "fullinertia", {I(0, 0), I(1, 1), I(2, 2), I(0, 1), I(0, 2), I(1, 2)});
  }

  void add_joint(const XMLElement& joint, XMLElement& body) {
    const std::string type = text(joint, "type"), name = text(joint, "name");
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
    const double lower = bound(limit, "lower"), upper = bound(limit, "upper");
    const bool says_range = type != "continuous" && (lower != 0 || upper != 0);
    if (says_range && !(lower < upper))
      fail(joint,
           "joint '{}' has no way to go from {} to {}: correct lower or upper, or make it fixed",
           name, lower, upper);
    const bool has_range = says_range && std::max(-lower, upper) < 1000;  // beyond: none is meant
    if (has_range) {
      if (type == "revolute" && std::max(-lower, upper) > 20)
        fail(joint, "joint '{}' goes from {} to {} rad: give radians, or make it continuous", name,
             lower, upper);
      set(out, "range", {lower, upper});
    } else if (type != "continuous") {
      ++how_.dropped["joint without a range"];
    }
    const XMLElement* const dynamics = joint.FirstChildElement("dynamics");
    for (const char* term : {"damping", "friction", "armature"}) {
      if (const double x = number(dynamics, term, 0); !(x >= 0))
        fail(*dynamics, "joint '{}': its {} is {:g}, and must be 0 or more", name, term, x);
    }
    set(out, "damping", {number(dynamics, "damping", 0)});
    set(out, "frictionloss", {number(dynamics, "friction", 0)});
    set(out, "armature", {number(dynamics, "armature", 0)});  // URDF itself has no word for it
    put_rated(mujoco_, name, bound(limit, "effort"), bound(limit, "velocity"));
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
    const auto found = joint_by_name_.find(leader);
    if (leader != follower && found != joint_by_name_.end() &&
        text(*found->second, "type") != "fixed")
      return leader;
    fail(mimic, "joint '{}': its <mimic> follows '{}', which is no other joint that moves",
         follower, leader);
  }

  XMLElement& mujoco_;
  const UrdfReading& how_;
  std::vector<std::string> problems_, impossible_, massless_;
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
