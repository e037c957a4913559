// SPDX-License-Identifier: Apache-2.0
#include "mjcf/trace/read/bag/json_type.h"

#ifdef TAUEXT_RAPIDJSON
#include <rapidjson/memorystream.h>
#include <rapidjson/reader.h>
#endif

#include <algorithm>
#include <cstdint>
#include <limits>
#include <stdexcept>
#include <utility>

#include "mjcf/trace/text.h"

namespace tauext {
namespace {

constexpr std::size_t kMostPaths = 10000;  // of a type
constexpr std::size_t kMostFields = 4096;  // likewise
constexpr std::size_t kMostLists = 64;     // of joints' names
constexpr std::size_t kLongestPath = 200;  // letters
constexpr std::size_t kMostLevels = 64;    // of objects and arrays in each other

}  // namespace

// of a member or, without a key, of what an array has
int JsonType::add_node(int parent, std::string_view key) {
  Node node;
  node.key = key;
  node.parent = parent;
  node.begin = at(parent).begin, node.end = at(parent).end;
  node.in_array = key.empty() || at(parent).in_array;
  if (!key.empty()) {
    std::string& path = node.in_array ? node.end : node.begin;
    if (parent > 0) path += '.';
    path += key;
  }
  if (nodes_.size() == kMostPaths || node.begin.size() + node.end.size() > kLongestPath)
    return kNone;
  nodes_.push_back(std::move(node));
  return static_cast<int>(nodes_.size()) - 1;
}

// `expected`: how many members came before it, as most messages have one order
int JsonType::member(int node, std::string_view key, std::size_t expected) {
  if (expected < at(node).order.size()) {
    const int next = at(node).order[expected];
    if (at(next).key == key) return next;
  }
  if (const auto known = at(node).members.find(key); known != at(node).members.end())
    return known->second;
  const int made = key.empty() ? kNone : add_node(node, key);
  if (made == kNone) return kNone;
  at(node).members.emplace(key, made);
  at(node).order.push_back(made);
  return made;
}

int JsonType::elements_of(int array) {
  if (at(array).in_array) return kNone;
  if (at(array).elements == kNone) {
    const int made = add_node(array, "");
    at(array).elements = made;
  }
  return at(array).elements;
}

int JsonType::field_of(int node, bool many) {
  if (many && at(node).in_array) return kNone;
  int& field = many ? at(node).many : at(node).one;
  if (field != kNone || fields_.size() == kMostFields || node == 0) return field;
  field = static_cast<int>(fields_.size());
  const Node& n = at(node);
  fields_.push_back({n.begin, n.end, many || n.in_array, many ? list_above(node) : kNone});
  field_nodes_.push_back(node);
  return field;
}

// the list of joints' names that this array of texts is
int JsonType::list_of(int array) {
  const Node& n = at(array);
  if (n.in_array || n.parent == kNone || (n.key != "joint_names" && n.key != "name")) return kNone;
  Node& object = at(n.parent);
  if (object.list == kNone && lists_ < kMostLists) {
    object.list = static_cast<int>(lists_++);
    object.list_member = array;
    for (std::size_t i = 0; i < fields_.size(); ++i) {
      const int node = field_nodes_[i];
      if (at(node).many == static_cast<int>(i)) fields_[i].names = list_above(node);
    }
  }
  return object.list_member == array ? object.list : kNone;
}

// that of the nearest object that has one
int JsonType::list_above(int node) {
  for (int n = at(node).parent; n != kNone; n = at(n).parent)
    if (at(n).list != kNone) return at(n).list;
  return kNone;
}

#ifdef TAUEXT_RAPIDJSON

JsonType::JsonType() : nodes_(1) {}

// takes a message as RapidJSON's reader meets it
class JsonWalk {
 public:
  using Ch = char;
  static constexpr const char* kNoJson = "it is no JSON";

  JsonWalk(JsonType& type, MessageNumbers& to) : type_(type), to_(to) { levels_.reserve(8); }

  const char* objection() const { return why_; }

  bool Null() { return take(std::numeric_limits<double>::quiet_NaN()); }
  bool Bool(bool x) { return take(x ? 1 : 0); }
  bool RawNumber(const Ch* text, rapidjson::SizeType size, bool) {
    const auto x = number_in<double>({text, size});
    return x ? take(*x) : fail(kNoJson);
  }
  // numbers come as they are written
  bool Int(int) { return fail(kNoJson); }
  bool Uint(unsigned) { return fail(kNoJson); }
  bool Int64(std::int64_t) { return fail(kNoJson); }
  bool Uint64(std::uint64_t) { return fail(kNoJson); }
  bool Double(double) { return fail(kNoJson); }

  bool String(const Ch* text, rapidjson::SizeType size, bool) {
    if (levels_.empty()) return fail(kNoObject);
    if (levels_.back().in_array && levels_.back().node != kNone) take_name({text, size});
    return finish_value();
  }
  bool Key(const Ch* text, rapidjson::SizeType size, bool) {
    Level& l = levels_.back();
    l.member = l.node == kNone ? kNone : type_.member(l.node, {text, size}, l.count);
    return true;
  }
  bool StartObject() {
    if (levels_.empty()) return enter(0, false);
    Level& above = levels_.back();
    if (!above.in_array) return enter(above.member, false);
    const bool is_field = above.node != kNone && above.count < kMostOfField;
    const int elements = is_field ? type_.elements_of(above.node) : kNone;
    if (elements != kNone) element_ = above.count;
    return enter(elements, false);
  }
  bool StartArray() {
    if (levels_.empty()) return fail(kNoObject);
    return enter(levels_.back().in_array ? kNone : levels_.back().member, true);
  }
  bool EndObject(rapidjson::SizeType) { return leave(); }
  bool EndArray(rapidjson::SizeType) { return leave(); }

 private:
  static constexpr int kNone = JsonType::kNone;
  static constexpr const char* kNoObject = "it is no object of JSON";

  // an object or an array that is open
  struct Level {
    int node;
    bool in_array;          // of it are the values that follow
    int member = kNone;     // else the one whose value follows
    std::size_t count = 0;  // values before
  };

  bool fail(const char* why) {
    if (why_ == nullptr) why_ = why;
    return false;
  }
  bool enter(int node, bool array) {
    if (levels_.size() == kMostLevels) return fail("it has too many levels");
    levels_.push_back({node, array});
    return true;
  }
  bool leave() {
    levels_.pop_back();
    return levels_.empty() || finish_value();
  }
  bool finish_value() {
    ++levels_.back().count;
    return true;
  }

  bool take(double x) {
    if (levels_.empty()) return fail(kNoObject);
    Level& l = levels_.back();
    const int node = l.in_array ? l.node : l.member;
    const int field = node == kNone ? kNone : type_.field_of(node, l.in_array);
    if (field == kNone) return finish_value();
    to_.numbers.resize(type_.fields_.size());
    std::vector<double>& numbers = to_.numbers[static_cast<std::size_t>(field)];
    if (l.in_array) {
      numbers.push_back(x);
      if (numbers.size() > kMostOfField) numbers.clear(), l.node = kNone;
    } else {
      const std::size_t i = type_.at(node).in_array ? element_ : 0;
      if (numbers.size() <= i) numbers.resize(i + 1, std::numeric_limits<double>::quiet_NaN());
      numbers[i] = x;
    }
    return finish_value();
  }

  void take_name(std::string_view name) {
    const int list = type_.list_of(levels_.back().node);
    if (list == kNone) return;
    to_.names.resize(type_.lists_);
    std::vector<std::string>& names = to_.names[static_cast<std::size_t>(list)];
    if (std::find(names.begin(), names.end(), name) != names.end())
      why_ = "it names a joint twice";
    else if (names.size() == kMostJoints)
      why_ = "it has more than 64 joints";
    else
      names.emplace_back(name);
  }

  JsonType& type_;
  MessageNumbers& to_;
  std::vector<Level> levels_;
  std::size_t element_ = 0;  // of the array that the object is in
  const char* why_ = nullptr;
};

// RapidJSON's own stack grows by the heap, and numbers are left to std
const char* JsonType::read(std::string_view bytes, MessageNumbers& to) {
  constexpr unsigned kFlags = rapidjson::kParseIterativeFlag |
                              rapidjson::kParseNumbersAsStringsFlag |
                              rapidjson::kParseValidateEncodingFlag;
  clear(to);
  JsonWalk walk(*this, to);
  rapidjson::MemoryStream stream(bytes.data(), bytes.size());
  const bool good = !rapidjson::Reader().Parse<kFlags>(stream, walk).IsError();
  if (const char* why = walk.objection()) return why;
  if (!good || stream.Tell() != bytes.size()) return JsonWalk::kNoJson;  // it ends at a 0, too
  to.names.resize(lists_), to.numbers.resize(fields_.size());
  return objection_to(to);
}

#else

JsonType::JsonType() {
  throw std::runtime_error(
      "messages in JSON are left out of this build: install Debian's rapidjson-dev, and build "
      "again");
}

const char* JsonType::read(std::string_view, MessageNumbers&) {
  return "it is JSON";
}

#endif

}  // namespace tauext
