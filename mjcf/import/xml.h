// SPDX-License-Identifier: Apache-2.0
/// @file
/// Small things about XML elements.
#pragma once

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <tinyxml2.h>

#include <cctype>
#include <cstddef>
#include <locale>
#include <map>
#include <sstream>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "mjcf/import/mendable.h"
#include "mjcf/import/schema.h"
#include "mjcf/trace/printable.h"

namespace tauext::detail {

using tinyxml2::XMLElement;

inline std::string_view name_of(const XMLElement& e) {
  return e.Name();
}

/// "" if there is none.
inline std::string text(const XMLElement& e, const char* attribute) {
  const char* const value = e.Attribute(attribute);
  return value == nullptr ? "" : value;
}

/// The attribute by which an element of another file than the user's own keeps its place, which a
/// copy of an element has no more.
inline constexpr const char* kPlace = "tauext:place";

/// "line 7" or, in an included or attached file, "hand.xml: line 7"; "" of what no file has.
inline std::string place_of(const XMLElement& e) {
  if (e.Attribute(kPlace) != nullptr) return text(e, kPlace);
  return e.GetLineNum() > 0 ? fmt::format("line {}", e.GetLineNum()) : "";
}

/// These words behind the element's place.
template <class... Args>
std::string at_line(const XMLElement& e, fmt::format_string<Args...> words, Args&&... args) {
  const std::string place = place_of(e);
  return one_line(place + (place.empty() ? "" : ": ") +
                  fmt::format(words, std::forward<Args>(args)...));
}
/// @throws std::runtime_error with the same
template <class... Args>
[[noreturn]] void fail(const XMLElement& e, fmt::format_string<Args...> words, Args&&... args) {
  throw std::runtime_error(at_line(e, words, std::forward<Args>(args)...));
}

/// The errors of a file, for one message.
class Problems {
 public:
  /// Whether it threw none.
  template <class Try>
  bool attempt(Try&& what) {
    try {
      what();
      return true;
    } catch (const Mendable& e) {
      add(e.what(), e.by());
    } catch (const std::runtime_error& e) {
      add(e.what());
    }
    return false;
  }
  void add(std::string problem, const Mending& by = {}) {
    all_.push_back(std::move(problem));
    by_.add(by);
  }
  std::size_t count() const { return all_.size(); }
  /// @throws Mendable with all of them, if there are any
  void raise() const {
    if (!all_.empty())
      throw Mendable(one_line(fmt::format("{}", fmt::join(all_, "; ")), 8000), by_);
  }

 private:
  std::vector<std::string> all_;
  Mending by_;
};

/// What is wrong with what was read, like "mismatched element"; "no element" if nothing is.
inline std::string error_of(const tinyxml2::XMLDocument& doc) {
  std::string words = doc.Error() ? doc.ErrorName() : "XML_ERROR_NO_ELEMENT";
  words.erase(0, std::string_view("XML_ERROR_").size());
  for (char& c : words) c = static_cast<char>(c == '_' ? ' ' : std::tolower(c));
  return words;
}

/// The name of the element around it, or "".
inline std::string_view parent_name(const XMLElement& e) {
  const XMLElement* const parent = e.Parent()->ToElement();
  return parent == nullptr ? std::string_view() : name_of(*parent);
}

/// Whether it stands in such an element, at any depth.
inline bool inside(const XMLElement& e, std::string_view section) {
  for (const tinyxml2::XMLNode* p = e.Parent(); p != nullptr && p->ToElement() != nullptr;
       p = p->Parent()) {
    if (name_of(*p->ToElement()) == section) return true;
  }
  return false;
}

/// Whether a body has a joint of its own.
inline bool has_joint(const tinyxml2::XMLNode& body) {
  return body.FirstChildElement("joint") != nullptr ||
         body.FirstChildElement("freejoint") != nullptr;
}

/// Whether it is a body's joint, and none of an equality, a tendon or a default.
inline bool is_joint(const XMLElement& e) {
  return (name_of(e) == "joint" || name_of(e) == "freejoint") && parent_name(e) == "body";
}

inline bool is_free(const XMLElement& joint) {
  return name_of(joint) == "freejoint" || text(joint, "type") == "free";
}

/// Calls visit(element) for every element within `at`; where it says false it may have deleted the
/// element.
template <class Visit>
void each(XMLElement& at, Visit&& visit) {
  for (XMLElement* e = at.FirstChildElement(); e != nullptr;) {
    XMLElement* const next = e->NextSiblingElement();
    if (visit(*e)) each(*e, visit);
    e = next;
  }
}

/// The numbers at the beginning of a text, apart by blanks.
inline std::vector<double> numbers_in(const std::string& text) {
  std::vector<double> all;
  std::istringstream in(text);
  in.imbue(std::locale::classic());
  for (double x = 0; in >> x;) all.push_back(x);
  return all;
}

/// An attribute, or that of its class: the one that it names, or a body around it, or the file's.
/// Actuators of all kinds share their defaults.
inline std::string with_defaults(XMLElement& root, const XMLElement& e, const char* attribute) {
  if (e.Attribute(attribute) != nullptr) return text(e, attribute);
  std::string name = text(e, "class");
  for (const tinyxml2::XMLNode* at = e.Parent(); name.empty() && at->ToElement() != nullptr;
       at = at->Parent())
    name = text(*at->ToElement(), "childclass");
  const XMLElement* found = nullptr;
  each(root, [&](XMLElement& d) {
    if (name_of(d) == "default" &&
        (name.empty() ? parent_name(d) != "default" : text(d, "class") == name))
      found = &d;
    return found == nullptr;
  });
  for (; found != nullptr && name_of(*found) == "default"; found = found->Parent()->ToElement()) {
    for (const XMLElement* v = found->LastChildElement(); v != nullptr;
         v = v->PreviousSiblingElement()) {
      const bool is_of = name_of(*v) == name_of(e) ||
                         (parent_name(e) == "actuator" && has_word(kActuators, name_of(*v)));
      if (is_of && v->Attribute(attribute) != nullptr) return text(*v, attribute);
    }
  }
  return "";
}

/// Deletes it and counts that; false, for `each`.
inline bool drop(XMLElement& e, const std::string& what, std::map<std::string, int>& dropped) {
  ++dropped[what];
  e.Parent()->DeleteChild(&e);
  return false;
}

}  // namespace tauext::detail
