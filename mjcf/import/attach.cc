// SPDX-License-Identifier: Apache-2.0
#include "mjcf/import/attach.h"

#include <fmt/format.h>

#include <filesystem>
#include <initializer_list>
#include <set>
#include <string_view>
#include <vector>

#include "mjcf/import/schema.h"

namespace tauext::detail {
namespace {

namespace fs = std::filesystem;
using tinyxml2::XMLNode;

// attributes that are names, or refer to one
constexpr std::string_view kNames =
    " name joint joint1 joint2 jointinparent body body1 body2 mesh material "
    "tendon "
    "tendon1 tendon2 site sidesite geom geom1 geom2 cranksite slidersite refsite ";

// an attribute of all <compiler>, the last of which is obeyed
std::string compiler(XMLElement& mujoco, const char* attribute, const char* otherwise) {
  std::string value = otherwise;
  each(mujoco, [&](XMLElement& e) {
    if (name_of(e) == "compiler" && e.Attribute(attribute) != nullptr) value = text(e, attribute);
    return true;
  });
  return value;
}

void refuse_other_compiler(const XMLElement& attach, XMLElement& parent, XMLElement& child) {
  struct Setting {
    const char *attribute, *otherwise;
  };
  for (const auto [attribute, otherwise] :
       std::initializer_list<Setting>{{"angle", "degree"},
                                      {"eulerseq", "xyz"},
                                      {"coordinate", "local"},
                                      {"autolimits", "true"},
                                      {"inertiafromgeom", "auto"},
                                      {"inertiagrouprange", "0 5"},
                                      {"balanceinertia", "false"},
                                      {"boundmass", "0"},
                                      {"boundinertia", "0"},
                                      {"settotalmass", "-1"},
                                      {"exactmeshinertia", "false"},
                                      {"fitaabb", "false"}}) {
    const std::string own = compiler(parent, attribute, otherwise),
                      other = compiler(child, attribute, otherwise);
    if (own != other)
      fail(
          attach,
          "the <compiler> of the model '{}' has {}=\"{}\", and this file has \"{}\": give both the "
          "same",
          text(attach, "model"), attribute, other, own);
  }
}

// each section of that name
std::vector<XMLElement*> sections(XMLElement& mujoco, const char* name) {
  std::vector<XMLElement*> all;
  for (XMLElement* e = mujoco.FirstChildElement(name); e != nullptr;
       e = e->NextSiblingElement(name))
    all.push_back(e);
  return all;
}

void set_names(XMLElement& mujoco, const std::string& prefix) {
  if (prefix.empty()) return;
  each(mujoco, [&](XMLElement& e) {
    for (const tinyxml2::XMLAttribute* a = e.FirstAttribute(); a != nullptr; a = a->Next())
      if (has_word(kNames, a->Name())) e.SetAttribute(a->Name(), (prefix + a->Value()).c_str());
    return true;
  });
}

void set_mesh_paths(XMLElement& mujoco, const std::string& folder) {
  std::string meshes;
  each(mujoco, [&](XMLElement& e) {
    if (name_of(e) != "compiler") return true;
    for (const char* const name : {"assetdir", "meshdir"})
      if (e.Attribute(name) != nullptr) meshes = text(e, name);
    return true;
  });
  each(mujoco, [&](XMLElement& e) {
    if (name_of(e) != "mesh" || e.Attribute("file") == nullptr) return true;
    if (e.Attribute("name") == nullptr)
      e.SetAttribute("name", fs::path(text(e, "file")).stem().c_str());
    e.SetAttribute("file", fs::absolute(fs::path(folder) / meshes / text(e, "file")).c_str());
    return true;
  });
}

bool has_class(XMLElement& mujoco, const std::string& name) {
  bool has = false;
  each(mujoco, [&](const XMLElement& e) {
    has = has || (name_of(e) == "default" && text(e, "class") == name);
    return true;
  });
  return has;
}

// The defaults of the model, as a class of its own within the file's, whose name is returned; the
// model's classes get names that begin with it, as both may have one of the same name.
std::string graft_defaults(const XMLElement& attach, XMLElement& parent, XMLElement& child) {
  for (const XMLElement* d : sections(parent, "default"))
    for (const XMLElement* e = d->FirstChildElement(); e != nullptr; e = e->NextSiblingElement())
      if (name_of(*e) != "default" && has_word(elements_of(kKept), name_of(*e)))
        fail(*e, "a default of all is not known beside an <attach> ({}); give that <{}> a class",
             place_of(attach), name_of(*e));
  std::string name, main = "main";
  for (int n = 1; name.empty() || has_class(parent, name) || has_class(child, name); ++n)
    name = fmt::format("tauext:attached{}", n);
  for (const XMLElement* d : sections(child, "default"))
    if (d->Attribute("class") != nullptr) main = text(*d, "class");
  each(child, [&](XMLElement& e) {
    for (const char* const which : {"class", "childclass"})
      if (const std::string own = text(e, which); !own.empty())
        e.SetAttribute(which, own == main ? name.c_str() : fmt::format("{}/{}", name, own).c_str());
    return true;
  });
  XMLElement* top = parent.FirstChildElement("default");
  if (top == nullptr) top = parent.InsertNewChildElement("default");
  XMLElement& all = *top->InsertNewChildElement("default");
  all.SetAttribute("class", name.c_str());
  for (const XMLElement* d : sections(child, "default"))
    for (const XMLNode* c = d->FirstChild(); c != nullptr; c = c->NextSibling())
      all.InsertEndChild(c->DeepClone(parent.GetDocument()));
  return name;
}

XMLElement* body_called(XMLElement& mujoco, const std::string& name) {
  XMLElement* found = nullptr;
  each(mujoco, [&](XMLElement& e) {
    if (name_of(e) == "body" && text(e, "name") == name) found = &e;
    return found == nullptr;
  });
  return found;
}

// Whether something beside the bodies refers to these alone.
bool is_about(XMLElement& e, const std::set<std::string>& names) {
  bool all = true;
  const auto look = [&](const XMLElement& at) {
    for (const tinyxml2::XMLAttribute* a = at.FirstAttribute(); a != nullptr; a = a->Next()) {
      const std::string_view what = a->Name();
      if (what == "name" || !has_word(kNames, what)) continue;
      all = all && names.count(a->Value()) > 0;
    }
    return true;
  };
  look(e);
  each(e, look);
  return all;
}

// @param main the class that the model's default of all has become
void graft_sections(XMLElement& parent, XMLElement& child, XMLElement& bodies,
                    const std::string& main) {
  std::set<std::string> names;  // of bodies, joints and sites that come along; then of tendons
  each(bodies, [&](const XMLElement& e) {
    names.insert(text(e, "name"));
    return true;
  });
  names.insert(text(bodies, "name"));
  for (const char* const name : {"asset", "tendon", "equality", "contact", "actuator"}) {
    for (XMLElement* const from : sections(child, name)) {
      XMLElement& to = *parent.InsertNewChildElement(name);
      for (XMLElement* e = from->FirstChildElement(); e != nullptr; e = e->NextSiblingElement()) {
        const bool kept =
            std::string_view(name) == "asset" ? name_of(*e) == "mesh" : is_about(*e, names);
        if (!kept) continue;
        XMLElement& copy = *e->DeepClone(parent.GetDocument())->ToElement();
        const bool may = std::string_view(name) != "contact";  // whose classes do not matter
        if (may && copy.Attribute("class") == nullptr) copy.SetAttribute("class", main.c_str());
        to.InsertEndChild(&copy);
        names.insert(text(*e, "name"));
      }
    }
  }
}

void graft(XMLElement& attach, XMLElement& parent, AttachedModel& model) {
  XMLElement& child = *model.doc.RootElement();
  const std::string prefix = text(attach, "prefix"), part = text(attach, "body");
  refuse_other_compiler(attach, parent, child);
  set_mesh_paths(child, model.folder);
  set_names(child, prefix);
  // a body without a joint: it is carried by the one around it
  XMLElement& place = *attach.GetDocument()->NewElement("body");
  attach.Parent()->InsertAfterChild(&attach, &place);
  const std::string main = graft_defaults(attach, parent, child);
  place.SetAttribute("childclass", main.c_str());
  if (part.empty()) {
    for (XMLElement* const world : sections(child, "worldbody"))
      for (const XMLNode* c = world->FirstChild(); c != nullptr; c = c->NextSibling())
        place.InsertEndChild(c->DeepClone(parent.GetDocument()));
  } else {
    XMLElement* const body = body_called(child, prefix + part);
    if (body == nullptr)
      fail(attach, "the model '{}' has no body '{}'", text(attach, "model"), part);
    for (const XMLNode* at = body->Parent(); at->ToElement() != nullptr; at = at->Parent()) {
      if (at->ToElement()->Attribute("childclass") == nullptr) continue;
      place.SetAttribute("childclass", at->ToElement()->Attribute("childclass"));
      break;
    }
    place.InsertEndChild(body->DeepClone(parent.GetDocument()));
  }
  graft_sections(parent, child, place, main);
  attach.Parent()->DeleteChild(&attach);
}

}  // namespace

void attach_models(XMLElement& mujoco,
                   const std::function<void(const std::string& file, AttachedModel& model)>& load) {
  std::vector<XMLElement*> all;
  each(mujoco, [&](XMLElement& e) {
    if (name_of(e) == "attach" && inside(e, "worldbody")) all.push_back(&e);
    return true;
  });
  for (XMLElement* const attach : all) {
    const std::string name = text(*attach, "model");
    std::string file;
    for (const XMLElement* const assets : sections(mujoco, "asset"))
      for (const XMLElement* m = assets->FirstChildElement("model"); m != nullptr;
           m = m->NextSiblingElement("model"))
        if (text(*m, "name") == name || fs::path(text(*m, "file")).stem() == name)
          file = text(*m, "file");
    if (name.empty() || file.empty() || attach->Attribute("frame") != nullptr)
      fail(*attach,
           "<attach> is known with a model of <asset> and, in it, a body: write out what it "
           "attaches (as newer MuJoCo does when it saves a model)");
    AttachedModel model;
    load(file, model);
    graft(*attach, mujoco, model);
  }
}

}  // namespace tauext::detail
