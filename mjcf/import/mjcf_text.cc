// SPDX-License-Identifier: Apache-2.0
#include "mjcf/import/mjcf_text.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <locale>
#include <set>
#include <sstream>
#include <stdexcept>
#include <string_view>
#include <vector>

#include "mjcf/import/attach.h"
#include "mjcf/import/drives.h"
#include "mjcf/import/lock.h"
#include "mjcf/import/masses/body_masses.h"
#include "mjcf/import/masses/inertia.h"
#include "mjcf/import/schema.h"
#include "mjcf/import/urdf.h"
#include "mjcf/import/xml.h"
#include "mjcf/trace/input_file.h"
#include "mjcf/trace/printable.h"
#include "mjcf/trace/text.h"

namespace tauext {
namespace {

namespace fs = std::filesystem;
using detail::each, detail::drop, detail::fail, detail::has_word, detail::inside, detail::name_of,
    detail::parent_name, detail::text;
using tinyxml2::XMLDocument, tinyxml2::XMLElement, tinyxml2::XMLNode;

class Import {
 public:
  Import(const std::string& path, const ImportOptions& options) : path_(path), options_(options) {}

  std::string root() { return load(doc_, path_).Name(); }

  // of all attributes but names and texts, in small letters
  template <class Visit>
  void each_word(Visit&& visit) {
    XMLElement& root = load(doc_, path_);
    include(root, fs::path(path_).parent_path(), 0);
    each(root, [&](XMLElement& e) {
      if (name_of(e) == "custom") return false;
      for (const tinyxml2::XMLAttribute* a = e.FirstAttribute(); a != nullptr; a = a->Next()) {
        const std::string_view attribute = a->Name();
        if (attribute.ends_with("name") || attribute.ends_with("class") ||
            attribute == detail::kPlace)
          continue;
        std::istringstream words(a->Value());
        for (std::string word; words >> word;) visit(e, a->Name(), in_small_letters(word));
      }
      return true;
    });
  }

  ImportedText run() {
    if (name_of(load(doc_, path_)) == "robot") {
      XMLDocument mjcf;
      detail::urdf_to_mjcf(*doc_.RootElement(), mjcf,
                           {options_.lock, options_.balance, options_.masses_unknown,
                            options_.measured.bodies, out_.dropped, out_.changed});
      mjcf.DeepCopy(&doc_);
    }
    XMLElement& root = *doc_.RootElement();
    if (name_of(root) != "mujoco") fail(root, "<{}> is no MJCF, and no URDF", name_of(root));
    include(root, fs::path(path_).parent_path(), 0);
    problems_.raise();
    strip_paths(root);
    attach(root, fs::path(path_).parent_path(), 0);
    refuse_unknown(root);
    read_settings(root);
    refuse_degrees(root);
    frames_to_bodies(root);
    problems_.raise();
    detail::keep_rated(root);
    problems_.attempt([&] { detail::keep_drive_dynamics(root, options_.lock, out_.changed); });
    keep(root);
    problems_.raise();
    detail::name_joints(root);
    detail::lock_joints(root, options_.lock, out_.dropped, out_.changed);
    detail::put_bodies(root, options_.measured.bodies);
    if (options_.masses_unknown) out_.massless = detail::fill_masses(root);
    mend_inertias(root);
    set_compiler(root);
    XMLElement* const option = root.InsertNewChildElement("option");
    option->SetAttribute("integrator", "RK4");
    if (weightless_) option->SetAttribute("gravity", "0 0 0");
    add_motors(root);
    detail::put_measured(root, options_.measured);
    each(root, [](XMLElement& e) {
      e.DeleteAttribute(detail::kPlace);
      return true;
    });
    tinyxml2::XMLPrinter printer;
    doc_.Print(&printer);
    out_.xml = printer.CStr();
    return std::move(out_);
  }

 private:
  XMLElement& load(XMLDocument& doc, const fs::path& file) {
    // who asks names the file itself
    const std::string where = file == path_ ? "" : file.string() + ": ";
    if (!fs::is_regular_file(file))
      throw std::runtime_error(one_line(where + (fs::is_directory(file) ? "it is a folder"
                                                 : fs::exists(file)     ? "it is no regular file"
                                                                        : "no such file")));
    if (fs::file_size(file) > kMostBytes)
      throw std::runtime_error(
          one_line(fmt::format("{}larger than {} MB", where, kMostBytes >> 20)));
    doc.LoadFile(file.c_str());
    if (fs::file_size(file) == 0) throw std::runtime_error(one_line(where + "the file is empty"));
    if (doc.Error() || doc.RootElement() == nullptr) {
      if (const char* const letters = utf16_of(file))
        throw std::runtime_error(one_line(fmt::format(
            "{}it is in UTF-16, and UTF-8 is read: iconv -f {} -t UTF-8 {} > {}", where, letters,
            shell_word(file.string()),
            shell_word(fs::path(file).replace_extension(".utf8" + file.extension().string())))));
      const int line = doc.ErrorLineNum();  // 0: in none of them
      throw std::runtime_error(one_line(fmt::format("{}{}no XML ({})", where,
                                                    line > 0 ? fmt::format("line {}: ", line) : "",
                                                    detail::error_of(doc))));
    }
    claim_input(file.string());
    const auto check = [&](XMLElement& e) {
      if (!where.empty()) e.SetAttribute(detail::kPlace, (where + detail::place_of(e)).c_str());
      refuse_controls(e);
      return true;
    };
    if (XMLElement* const second = doc.RootElement()->NextSiblingElement(); second != nullptr) {
      check(*second);
      fail(*second, "a second <{}> behind the first", name_of(*second));
    }
    check(*doc.RootElement());
    each(*doc.RootElement(), check);
    return *doc.RootElement();
  }

  // by the mark at its beginning, or by the zero beside its first letter
  // as iconv calls it; null if it is not in it
  static const char* utf16_of(const fs::path& file) {
    std::string begin(2, ' ');
    std::ifstream(file).read(begin.data(), 2);
    if (begin == "\xFF\xFE" || begin == "\xFE\xFF") return "UTF-16";
    return begin[0] == '\0' ? "UTF-16BE" : begin[1] == '\0' ? "UTF-16LE" : nullptr;
  }

  // XML must not have them, and terminals obey them
  static void refuse_controls(const XMLElement& e) {
    for (const tinyxml2::XMLAttribute* a = e.FirstAttribute(); a != nullptr; a = a->Next()) {
      for (const char* c = a->Value(); *c != '\0'; ++c)
        if (std::iscntrl(static_cast<unsigned char>(*c)) &&
            !std::isspace(static_cast<unsigned char>(*c)))
          fail(e, "{} of <{}> has a control character: {}", a->Name(), name_of(e), a->Value());
    }
  }

  // <compiler strippath="true"/>: a mesh's file is known by its name alone
  static void strip_paths(XMLElement& root) {
    bool strips = false;
    each(root, [&](XMLElement& e) {
      if (name_of(e) != "compiler" || e.Attribute("strippath") == nullptr) return true;
      strips = text(e, "strippath") == "true";
      e.DeleteAttribute("strippath");
      return true;
    });
    each(root, [&](XMLElement& e) {
      if (strips && name_of(e) == "mesh" && e.Attribute("file") != nullptr)
        e.SetAttribute("file", fs::path(text(e, "file")).filename().c_str());
      return true;
    });
  }

  // <attach model=".."/> by what it stands for, whose own files are looked for in its own folder
  void attach(XMLElement& root, const fs::path& folder, int depth) {
    if (depth > 20) fail(root, "models are attached to each other in a ring");
    detail::attach_models(root, [&](const std::string& file, detail::AttachedModel& model) {
      XMLElement& other = load(model.doc, folder / file);
      model.folder = (folder / file).parent_path().string();
      include(other, model.folder, 0);
      problems_.raise();
      strip_paths(other);
      attach(other, model.folder, depth + 1);
    });
  }

  // <include file=".."/> by the content of that file, which is looked for beside the first file,
  // and then, as newer MuJoCo has it, beside the one that includes it
  void include(XMLElement& at, const fs::path& folder, int depth, const fs::path& beside = {}) {
    for (XMLElement* e = at.FirstChildElement(); e != nullptr;) {
      XMLElement* const next = e->NextSiblingElement();
      if (name_of(*e) == "include") {
        const std::string file = text(*e, "file");
        const bool is_new = including_.insert(file).second;
        problems_.attempt([&] {
          if (depth > 20 || !is_new) fail(*e, "'{}' includes itself", file);
          if (++includes_ > kMostIncludes)
            fail(*e, "more than {} files are included", kMostIncludes);
          XMLDocument other;
          fs::path path = folder / file;
          if (!beside.empty() && !fs::exists(path) && fs::exists(beside / file))
            path = beside / file;
          XMLElement& root = load(other, path);
          include(root, folder, depth + 1, path.parent_path());
          XMLNode* behind = e;
          for (XMLNode* c = root.FirstChild(); c != nullptr; c = c->NextSibling())
            behind = at.InsertAfterChild(behind, c->DeepClone(at.GetDocument()));
        });
        if (is_new) including_.erase(file);
        at.DeleteChild(e);
      } else {
        include(*e, folder, depth, beside);
      }
      e = next;
    }
  }

  void refuse_unknown(XMLElement& root) {
    std::vector<std::string> found;
    each(root, [&](XMLElement& e) {
      const auto* const end = std::end(detail::kUnknown);
      if (!inside(e, "worldbody") ||
          std::find(std::begin(detail::kUnknown), end, name_of(e)) == end)
        return true;
      found.push_back(fmt::format("<{}> ({})", name_of(e), detail::place_of(e)));
      return false;
    });
    if (found.empty()) return;
    throw std::runtime_error(
        one_line(fmt::format("MuJoCo 2.2.2 does not know {} within a body; write its bodies out "
                             "(as newer MuJoCo does when it saves a model)",
                             fmt::join(found, ", ")),
                 8000));
  }

  // What stands in a <frame> is carried by the body around it, as by a body without a joint. Where
  // that has an <inertial>, shapes in a frame have no mass, either.
  void frames_to_bodies(XMLElement& root) {
    std::set<const XMLNode*> frames;
    each(root, [&](XMLElement& e) {
      if (name_of(e) != "frame" || !inside(e, "worldbody")) return true;
      const XMLNode* carrier = e.Parent();
      while (frames.count(carrier) > 0) carrier = carrier->Parent();
      if (const XMLElement* const joint = e.FirstChildElement("joint"))
        problems_.attempt(
            [&] { fail(*joint, "a <joint> in a <frame>: write it into the body around that"); });
      const bool has_mass = !from_geom_ && carrier->FirstChildElement("inertial") != nullptr;
      for (XMLElement* g = e.FirstChildElement("geom"); g != nullptr && has_mass;) {
        XMLElement* const next = g->NextSiblingElement("geom");
        drop(*g, "geom in a frame", out_.dropped);
        g = next;
      }
      if (!has_mass) give_some_mass(*e.Parent()->ToElement());
      e.SetName("body");
      e.DeleteAttribute("name");  // another element may have it
      frames.insert(&e);
      return true;
    });
  }

  // MuJoCo 2.2.2 wants a mass in a body that moves, whatever it carries
  static void give_some_mass(XMLElement& carrier) {
    if (!detail::has_joint(carrier)) return;
    XMLElement& geom = *carrier.InsertNewChildElement("geom");
    geom.SetAttribute("type", "sphere");
    geom.SetAttribute("size", "1");
    geom.SetAttribute("mass", "1e-12");
    geom.SetAttribute("contype", "0");
    geom.SetAttribute("conaffinity", "0");
  }

  void read_settings(XMLElement& root) {
    each(root, [&](XMLElement& e) {
      if (text(e, "mocap") == "true" && e.Attribute("name") != nullptr)
        mocap_.insert(text(e, "name"));
      if (name_of(e) == "tendon" && inside(e, "default"))
        tendons_have_forces_ = tendons_have_forces_ || has_forces(e);
      if (name_of(e) == "geom" && inside(e, "default"))
        class_has_mesh_ = class_has_mesh_ || e.Attribute("mesh") != nullptr;
      if (name_of(e) != "compiler") return true;
      if (e.Attribute("inertiafromgeom") != nullptr)
        from_geom_ = text(e, "inertiafromgeom") == "true";
      if (e.Attribute("angle") != nullptr) radians_ = text(e, "angle") == "radian";
      if (e.Attribute("balanceinertia") != nullptr) balances_ = text(e, "balanceinertia") == "true";
      by_group_ = by_group_ || e.Attribute("inertiagrouprange") != nullptr;
      total_mass_ = total_mass_ || e.DoubleAttribute("settotalmass", -1) > 0;
      return true;
    });
  }

  // in a file of radians
  void refuse_degrees(XMLElement& root) {
    each(root, [&](XMLElement& e) {
      if (!radians_ || e.Attribute("euler") == nullptr) return true;
      for (const double x : detail::numbers_in(text(e, "euler")))
        if (std::abs(x) > 4 * M_PI)
          problems_.attempt([&] {
            fail(e,
                 "euler of <{}> is '{}', more than two turns: <compiler angle=\"radian\"/> says "
                 "that it is in rad, and this may be degrees",
                 name_of(e), text(e, "euler"));
          });
      return true;
    });
  }

  // meshes are needed where a joint moves them, and no <inertial> says the mass; or where all
  // masses are scaled by their sum
  bool mass_is_of_geoms(const XMLElement& geom) const {
    const XMLNode* at = geom.Parent();
    if (!from_geom_ && at->FirstChildElement("inertial") != nullptr) return false;
    if (total_mass_) return name_of(*at->ToElement()) != "worldbody";
    return moves(*at);
  }

  static bool moves(const XMLNode& body) {
    const XMLNode* at = &body;
    while (at != nullptr && !detail::has_joint(*at)) at = at->Parent();
    return at != nullptr;
  }

  static std::string_view attributes_of(const XMLElement& e) {
    if (name_of(e) == "joint") {
      if (parent_name(e) == "equality") return detail::kJointEquality;
      if (parent_name(e) == "fixed") return detail::kFixedJoint;
    }
    if (name_of(e) == "tendon" && parent_name(e) == "equality") return detail::kTendonEquality;
    for (const detail::Kept& k : detail::kKept) {
      if (k.element == name_of(e)) return k.attributes;
    }
    return {};
  }

  void keep(XMLElement& root) {
    while (root.FirstAttribute() != nullptr &&
           std::string_view(root.FirstAttribute()->Name()) != "model")
      root.DeleteAttribute(root.FirstAttribute()->Name());
    std::set<std::string> meshes;
    each(root, [&](XMLElement& e) {
      bool goes_on = false;
      problems_.attempt([&] { goes_on = keep_element(e, meshes); });
      return goes_on;
    });
    each(root, [&](XMLElement& e) {
      if (name_of(e) != "mesh" || inside(e, "default")) return true;
      std::string name = text(e, "name");
      if (name.empty()) name = fs::path(text(e, "file")).stem().string();
      if (meshes.count(name) == 0) return drop(e, "mesh", out_.dropped);
      e.SetAttribute("name", name.c_str());  // MuJoCo 2.2.2 ends it at the first point
      problems_.attempt([&] { refuse_new_inertia(e, name); });
      return true;
    });
  }

  void refuse_new_inertia(const XMLElement& mesh, const std::string& name) const {
    const auto own = mesh_inertia_.find(&mesh);
    const std::string how = own == mesh_inertia_.end() ? default_mesh_inertia_ : own->second;
    if (!how.empty() && how != "legacy")
      fail(mesh,
           "the mesh '{}' has inertia=\"{}\", which MuJoCo 2.2.2 does not know, and a mass comes "
           "from it: write an <inertial> into the bodies that have it",
           name, how);
  }

  // false where it was left out
  bool keep_element(XMLElement& e, std::set<std::string>& meshes) {
    const std::string_view attributes = attributes_of(e);
    if (name_of(e) == "spatial" && (has_forces(e) || tendons_have_forces_))
      fail(e,
           "a <spatial> tendon, or its default, has stiffness, damping, frictionloss or armature, "
           "which no estimator here knows; take that out");
    if (name_of(e) == "plugin" && parent_name(e) == "body" && moves(*e.Parent()))
      fail(e, "a <plugin> acts on the body '{}', and what it does is not known here: take it out",
           text(*e.Parent()->ToElement(), "name"));
    if (name_of(e) == "flag") obey(e);
    if (attributes.empty()) {
      if (!has_word(detail::kLeftOutElements, name_of(e)) &&
          !has_word(detail::kActuators, name_of(e)))
        fail(e, "this import knows no <{}>; {}", name_of(e),
             detail::remedy_for(name_of(e), detail::elements_of(detail::kKept)));
      return drop_section(e);
    }
    if (parent_name(e) == "equality" &&
        (mocap_.count(text(e, "body1")) > 0 || mocap_.count(text(e, "body2")) > 0))
      return drop(e, "equality that drags by a mocap body", out_.dropped);  // as an actuator would
    if (name_of(e) == "geom" && !inside(e, "default")) {
      if (e.Attribute("hfield") != nullptr) return drop(e, "geom (hfield)", out_.dropped);
      if (const std::string mesh = class_has_mesh_
                                       ? detail::with_defaults(*doc_.RootElement(), e, "mesh")
                                       : text(e, "mesh");
          !mesh.empty()) {
        if (!mass_is_of_geoms(e)) return drop(e, "geom (mesh)", out_.dropped);
        meshes.insert(mesh);
      }
    }
    if (name_of(e) == "mesh" && e.Attribute("inertia") != nullptr) {
      if (inside(e, "default"))
        default_mesh_inertia_ = text(e, "inertia");
      else
        mesh_inertia_[&e] = text(e, "inertia");
    }
    if (name_of(e) == "numeric" && !text(e, "name").starts_with(detail::kMeasured))
      return drop(e, "numeric", out_.dropped);
    keep_attributes(e, attributes);
    return true;
  }

  // what it switches off would come back with it left out
  void obey(const XMLElement& flag) {
    weightless_ = weightless_ || text(flag, "gravity") == "disable";
    for (const char* what :
         {"constraint", "equality", "frictionloss", "passive", "spring", "damper"})
      if (text(flag, what) == "disable")
        fail(flag, "<flag> switches {} off; take that out, and what it switches off", what);
  }

  static bool has_forces(const XMLElement& tendon) {
    bool any = false;
    for (const char* force : {"stiffness", "damping", "frictionloss", "armature"})
      for (const double x : detail::numbers_in(text(tendon, force))) any = any || x != 0;
    return any;
  }

  // counts what is in it
  bool drop_section(XMLElement& e) {
    const std::string name(name_of(e));
    for (const XMLElement* c = e.FirstChildElement(); c != nullptr; c = c->NextSiblingElement())
      if (c->NextSiblingElement() != nullptr) ++out_.dropped[name];
    return drop(e, name, out_.dropped);
  }

  static bool is_left_out(const XMLElement& e, const std::string& attribute) {
    for (const detail::Kept& k : detail::kLeftOut) {
      if (k.element == name_of(e)) return has_word(k.attributes, attribute);
    }
    return false;
  }

  void keep_attributes(XMLElement& e, std::string_view kept) {
    for (const tinyxml2::XMLAttribute* a = e.FirstAttribute(); a != nullptr;) {
      const std::string attribute = a->Name();
      a = a->Next();
      if (has_word(kept, attribute) || attribute == detail::kPlace ||
          (by_group_ && attribute == "group"))
        continue;
      if (!is_left_out(e, attribute)) {
        problems_.attempt([&] {
          fail(e, "<{}> has no attribute '{}' that this import knows; {}", name_of(e), attribute,
               detail::remedy_for(attribute, kept));
        });
      }
      if (attribute != "rgba" && attribute != "material" && attribute != "group")
        ++out_.dropped[fmt::format("{}.{}", name_of(e), attribute)];
      e.DeleteAttribute(attribute.c_str());
    }
  }

  // MuJoCo judges every body by itself
  void mend_inertias(XMLElement& root) {
    if (from_geom_) return;
    std::vector<std::string> all;
    each(root, [&](XMLElement& e) {
      if (name_of(e) != "inertial") return true;
      const bool diagonal = e.Attribute("diaginertia") != nullptr;
      const char* const attribute = diagonal ? "diaginertia" : "fullinertia";
      std::istringstream in(text(e, attribute));
      in.imbue(std::locale::classic());
      double I[6] = {};
      for (int i = 0; i < (diagonal ? 3 : 6); ++i)
        if (!(in >> I[i])) return true;  // MuJoCo will say it
      Eigen::Matrix3d tensor;
      tensor << I[0], I[3], I[4], I[3], I[1], I[5], I[4], I[5], I[2];
      if (tensor.isZero(0)) return true;  // a point
      const detail::MendedInertia m = detail::mended(tensor, e.DoubleAttribute("mass", 0));
      const double missing = m.moments[2] - m.moments[0] - m.moments[1];
      if (m.moments[0] >= 0 && missing <= 0) return true;
      const std::string body = text(*e.Parent()->ToElement(), "name");
      if (balances_ && m.moments[0] >= 0) {  // by MuJoCo, which makes a ball of it
        const double mean = m.moments.sum() / 3;
        ++out_.changed[fmt::format("inertia of '{}' by {:.2g} %, by the file's balanceinertia",
                                   body, 100 * (m.moments[2] - mean) / m.moments[2])];
        return true;
      }
      if (!m.few_digits && !options_.balance) {
        all.push_back(detail::impossible(body, detail::place_of(e), m.moments));
        return true;
      }
      if (m.change > 1e-8)
        ++out_.changed[fmt::format("inertia of '{}' by {:.2g} %", body, 100 * m.change)];
      const Eigen::Matrix3d& M = m.inertia;
      std::string words = fmt::format("{:.17g} {:.17g} {:.17g}", M(0, 0), M(1, 1), M(2, 2));
      if (!diagonal) words += fmt::format(" {:.17g} {:.17g} {:.17g}", M(0, 1), M(0, 2), M(1, 2));
      e.SetAttribute(attribute, words.c_str());
      return true;
    });
    if (!all.empty())
      throw Mendable(one_line(detail::impossible_inertias(all), 8000),
                     {.lock = {}, .balance = true});
  }

  // the last <compiler> is obeyed; newer MuJoCo's default is that a range limits
  void set_compiler(XMLElement& root) {
    bool limits_are_set = false;
    std::string folder;
    each(root, [&](XMLElement& e) {
      if (name_of(e) != "compiler") return true;
      limits_are_set = limits_are_set || e.Attribute("autolimits") != nullptr;
      for (const char* const name : {"assetdir", "meshdir"}) {
        if (e.Attribute(name) != nullptr) folder = text(e, name);
        e.DeleteAttribute(name);
      }
      return true;
    });
    if (!limits_are_set) root.InsertNewChildElement("compiler")->SetAttribute("autolimits", true);
    set_mesh_paths(root, fs::absolute(path_).parent_path() / folder);
  }

  // of the meshes that are left
  void set_mesh_paths(XMLElement& root, const fs::path& folder) const {
    each(root, [&](XMLElement& e) {
      if (name_of(e) != "mesh" || e.Attribute("file") == nullptr) return true;
      const fs::path file = folder / text(e, "file");
      e.SetAttribute("file", options_.folder.empty()
                                 ? file.c_str()
                                 : fs::proximate(file, options_.folder).c_str());
      return true;
    });
  }

  // on joints that follow no other
  void add_motors(XMLElement& root) {
    std::vector<std::string> joints;
    std::set<std::string> followers;
    each(root, [&](XMLElement& e) {
      if (parent_name(e) != "equality") return true;
      if (text(e, "active") == "false") return drop(e, "equality that is not active", out_.dropped);
      if (name_of(e) == "joint") followers.insert(text(e, "joint1"));
      return true;
    });
    each(root, [&](XMLElement& e) {
      if (detail::is_joint(e) && name_of(e) == "joint") joints.push_back(text(e, "name"));
      return true;
    });
    XMLElement* const actuators = root.InsertNewChildElement("actuator");
    for (const std::string& j : joints) {
      if (followers.count(j) > 0) continue;
      XMLElement* const motor = actuators->InsertNewChildElement("motor");
      motor->SetAttribute("name", j.c_str());
      motor->SetAttribute("joint", j.c_str());
    }
  }

  static constexpr int kMostIncludes = 1000;  // a file may be included by several
  static constexpr std::uintmax_t kMostBytes = 64u << 20;

  std::string path_;
  ImportOptions options_;
  XMLDocument doc_;
  ImportedText out_;
  detail::Problems problems_;
  bool from_geom_ = false, balances_ = false, tendons_have_forces_ = false;
  int includes_ = 0;
  bool weightless_ = false, total_mass_ = false, class_has_mesh_ = false;
  bool radians_ = false;   // whether angles are
  bool by_group_ = false;  // whether the group of a shape says if it has a mass
  std::set<std::string> including_, mocap_;
  std::map<const XMLElement*, std::string> mesh_inertia_;  // where one says how it is found
  std::string default_mesh_inertia_;
};

std::string counted(const std::map<std::string, int>& all) {
  std::vector<std::string> words;
  for (const auto& [what, n] : all)
    words.push_back(fmt::format("{} {}", n, printable_name(what, 200)));
  return fmt::format("{}", fmt::join(words, ", "));
}

}  // namespace

std::string in_words(const ImportedText& text) {
  std::string words;
  if (!text.changed.empty()) words = "changed: " + counted(text.changed);
  if (text.dropped.empty()) return words;
  return words + (words.empty() ? "" : "; ") + "left out: " + counted(text.dropped);
}

bool is_urdf(const std::string& path) {
  return Import(path, {}).root() == "robot";
}

void refuse_nan(const std::string& path) {
  Import(path, {}).each_word([](XMLElement& e, const char* attribute, const std::string& word) {
    if (word == "nan") fail(e, "{} of <{}> is {}", attribute, name_of(e), word);
  });
}

void refuse_commas(const std::string& path) {
  Import(path, {}).each_word([](XMLElement& e, const char* attribute, const std::string& word) {
    const std::size_t comma = word.find(',');
    if (comma != word.npos && comma + 1 < word.size() &&
        word.find_first_not_of("+-.,0123456789e") == word.npos)
      fail(e, "{} of <{}> is {}: write decimals behind a point, and spaces between numbers",
           attribute, name_of(e), word);
  });
}

ImportedText import_mjcf(const std::string& path, const ImportOptions& options) {
  return Import(path, options).run();
}

}  // namespace tauext
