// SPDX-License-Identifier: Apache-2.0
#include "mjcf/trace/read/bag/message_type.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>
#include <map>
#include <optional>
#include <stdexcept>
#include <utility>

#include "mjcf/trace/printable.h"
#include "mjcf/trace/read/numpy/npy_header.h"
#include "mjcf/trace/text.h"

namespace tauext {

// a field, or the whole message
struct RosType::Node {
  enum class Kind { kNumber, kText, kStructure };
  static constexpr std::int64_t kCounted = -1;  // the message says how many there are

  Kind kind = Kind::kStructure;
  NpyNumber number;
  std::int64_t count = 1;
  std::vector<Node> fields;  // of a structure
  int field = -1;            // of fields(), where its numbers go
  int names = -1;            // the list that it is, or that says whose its numbers are
};

namespace detail {

// a line of a definition
struct DefinedField {
  std::string type, name;
  bool array = false;
  std::int64_t count = 1;  // kCounted of a sequence
  bool operator==(const DefinedField&) const = default;
};
using Definitions = std::map<std::string, std::vector<DefinedField>>;

}  // namespace detail

namespace {

using detail::DefinedField;
using detail::Definitions;

constexpr std::size_t kMostNodes = 10000;  // of a type
constexpr std::size_t kDeepest = 20;       // structures in structures
constexpr std::size_t kEncapsulation = 4;  // [bytes] behind which offsets are counted
constexpr std::size_t kMostPadding = 8;    // [bytes] behind a message
constexpr std::string_view kRootOfBuiltIn = "sensor_msgs/JointState";
constexpr std::string_view kBuiltIn =
    "std_msgs/Header header\nstring[] name\nfloat64[] position\nfloat64[] velocity\n"
    "float64[] effort\n"
    "MSG: std_msgs/Header\nbuiltin_interfaces/Time stamp\nstring frame_id\n"
    "MSG: builtin_interfaces/Time\nint32 sec\nuint32 nanosec\n";

struct NumberType {
  std::string_view name;
  NpyNumber number;
};
constexpr NumberType kNumberTypes[] = {
    {"bool", {'b', 1}},    {"byte", {'u', 1}},  {"char", {'u', 1}},   {"int8", {'i', 1}},
    {"uint8", {'u', 1}},   {"int16", {'i', 2}}, {"uint16", {'u', 2}}, {"int32", {'i', 4}},
    {"uint32", {'u', 4}},  {"int64", {'i', 8}}, {"uint64", {'u', 8}}, {"float32", {'f', 4}},
    {"float64", {'f', 8}},
};

bool is_word(std::string_view s, std::string_view others) {
  return !s.empty() && std::all_of(s.begin(), s.end(), [&](char c) {
    return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') ||
           others.find(c) != others.npos;
  });
}

// "float64[7]", "float64[<=7]", "string<=10[]"
bool read_type(std::string_view text, DefinedField& f) {
  if (text.ends_with(']')) {
    const std::size_t at = text.rfind('[');
    if (at == text.npos) return false;
    const std::string_view size = text.substr(at + 1, text.size() - at - 2);
    text = text.substr(0, at);
    f.array = true;
    f.count = -1;
    if (!size.empty() && !size.starts_with("<=")) {
      f.count = number_in<std::int64_t>(size).value_or(0);
      if (f.count < 1 || f.count > INT32_MAX) return false;
    }
  }
  f.type = short_type_name(text.substr(0, text.find("<=")));
  return is_word(f.type, "_/");
}

// nothing of a constant
std::optional<DefinedField> read_field(std::string_view line, const std::string& type) {
  const std::size_t blank = line.find_first_of(" \t");
  const std::string_view rest =
      blank == line.npos ? std::string_view() : without_blanks(line.substr(blank));
  const std::string_view name = rest.substr(0, rest.find_first_of(" \t="));
  DefinedField f;
  if (!is_word(name, "_") || !read_type(line.substr(0, blank), f))
    throw std::runtime_error(fmt::format("the definition of {} has a line that is no field: '{}'",
                                         printable_name(type), printable_name(line)));
  f.name = name;
  if (without_blanks(rest.substr(name.size())).starts_with('=')) return std::nullopt;
  return f;
}

Definitions read_definitions(const std::string& root, std::string_view text) {
  Definitions all;
  std::string type = root;
  std::vector<DefinedField> fields;
  const auto finish = [&] {
    const auto [at, is_new] = all.emplace(type, fields);
    if (!is_new && at->second != fields && !fields.empty() && !at->second.empty())
      throw std::runtime_error(
          fmt::format("the type {} is defined in two ways", printable_name(type)));
    if (at->second.empty()) at->second = fields;
    fields.clear();
  };
  for (std::string_view line : split(text, '\n')) {
    line = without_blanks(line.substr(0, line.find('#')));
    if (line.find_first_not_of('=') == line.npos) continue;
    if (line.starts_with("IDL:"))
      throw std::runtime_error(fmt::format("{} is defined in IDL, which is not read",
                                           printable_name(without_blanks(line.substr(4)))));
    if (line.starts_with("MSG:")) {
      finish();
      type = short_type_name(without_blanks(line.substr(4)));
    } else if (auto f = read_field(line, type)) {
      fields.push_back(std::move(*f));
    }
  }
  finish();
  return all;
}

// of the first bytes of a message
const char* objection_to_encapsulation(std::string_view bytes) {
  if (bytes.starts_with("\x28\xB5\x2F\xFD")) {
    return "it is compressed: write the bag without compression by ros2 bag convert";
  }
  if (bytes.size() < kEncapsulation) return "it is cut off";
  return bytes[0] == 0 && (bytes[1] == 0 || bytes[1] == 1) ? nullptr : "it is no plain CDR";
}

// numbers are aligned to their size; beyond the end they are 0
class Cdr {
 public:
  Cdr(std::string_view body, bool big) : body_(body), big_(big) {}

  bool cut_off() const { return cut_off_; }
  std::size_t left() const { return body_.size() - at_; }
  std::uint32_t count() { return static_cast<std::uint32_t>(number({'u', 4})); }
  double number(NpyNumber n) {
    n.big = big_;
    align(n.size);
    const std::string_view bytes = take(static_cast<std::uint64_t>(n.size));
    return cut_off_ ? 0 : n.value(reinterpret_cast<const unsigned char*>(bytes.data()));
  }
  // as many as an array of a field may have
  void numbers(NpyNumber n, std::uint64_t count, std::vector<double>& to) {
    if (count == 0) return;
    n.big = big_;
    align(n.size);
    const std::string_view bytes = take(count * static_cast<std::uint64_t>(n.size));
    if (cut_off_) return;
    constexpr bool kLittle = std::endian::native == std::endian::little;
    if (kLittle && to.empty() && n.kind == 'f' && n.size == 8 && !n.big) {
      to.resize(count);
      std::memcpy(to.data(), bytes.data(), bytes.size());
      return;
    }
    const auto* at = reinterpret_cast<const unsigned char*>(bytes.data());
    for (std::uint64_t i = 0; i < count && to.size() < kMostOfField; ++i, at += n.size)
      to.push_back(n.value(at));
  }
  void skip(const NpyNumber& n, std::uint64_t count) {
    if (count == 0) return;
    align(n.size);
    take(count * static_cast<std::uint64_t>(n.size));
  }
  std::string_view text() {
    std::string_view s = take(count());
    if (!s.empty() && s.back() == '\0') s.remove_suffix(1);  // which its length counts
    return s;
  }

 private:
  void align(int size) { take((static_cast<std::size_t>(size) - at_ % size) % size); }
  std::string_view take(std::uint64_t size) {
    cut_off_ = cut_off_ || size > body_.size() - at_;
    if (cut_off_) return {};
    at_ += size;
    return body_.substr(at_ - size, size);
  }

  std::string_view body_;
  std::size_t at_ = 0;
  bool big_, cut_off_ = false;
};

}  // namespace

std::string short_type_name(std::string_view type) {
  std::string name(type);
  if (const auto at = name.find("/msg/"); at != name.npos) name.erase(at, 4);
  return name;
}

// lays out a type, with all types in it
class MessageCompiler {
 public:
  MessageCompiler(RosType& to, detail::Definitions definitions)
      : to_(to), definitions_(std::move(definitions)) {}

  // where a field stands
  struct Place {
    std::string begin, end;  // of its path
    bool in_array = false;
    bool is_field = true;  // its numbers have a name
    int names = -1;        // the list beside it, or beside what it is in
  };

  RosType::Node structure(const std::string& type, Place place) {
    const auto known = definitions_.find(type);
    if (known == definitions_.end()) fail("needs the type {}, which it does not define", type);
    if (std::find(within_.begin(), within_.end(), type) != within_.end())
      fail("has the type {} within itself", type);
    if (within_.size() == kDeepest) fail("has too many structures in {}", type);
    within_.push_back(type);
    RosType::Node node;
    const std::vector<detail::DefinedField>& fields = known->second;
    const auto list =
        std::find_if(fields.begin(), fields.end(), [&](const auto& f) { return is_list(f, type); });
    std::int64_t listed = RosType::Node::kCounted;
    if (list != fields.end() && !place.in_array) {
      place.names = static_cast<int>(to_.lists_++);
      listed = list->count;
    }
    for (const detail::DefinedField& f : fields) {
      const bool is_it = list != fields.end() && &f == &*list && !place.in_array;
      node.fields.push_back(field(f, type, place, listed));
      if (is_it) node.fields.back().names = place.names;
    }
    // what IDL puts into a structure that has nothing
    if (fields.empty()) node.fields.push_back(number_node({'u', 1}, 1));
    within_.pop_back();
    return node;
  }

 private:
  using Node = RosType::Node;

  static bool is_list(const detail::DefinedField& f, const std::string& type) {
    const bool named = f.name == "joint_names" || (f.name == "name" && type == kRootOfBuiltIn);
    return named && f.array && f.type == "string";
  }

  template <class Name>
  [[noreturn]] void fail(fmt::format_string<std::string> what, const Name& name) const {
    throw std::runtime_error("its definition " + fmt::format(what, printable_name(name)));
  }

  Node number_node(const NpyNumber& number, std::int64_t count) const {
    Node node;
    node.kind = Node::Kind::kNumber;
    node.number = number, node.count = count;
    return node;
  }

  Node field(const detail::DefinedField& f, const std::string& type, Place place,
             std::int64_t listed) {
    if (++nodes_ > kMostNodes) fail("has too many fields in {}", type);
    const std::string_view dot =
        place.begin.empty() && place.end.empty() && !place.in_array ? "" : ".";
    (place.in_array ? place.end : place.begin).append(dot).append(f.name);
    const auto number = std::find_if(std::begin(kNumberTypes), std::end(kNumberTypes),
                                     [&](const NumberType& n) { return n.name == f.type; });
    if (number != std::end(kNumberTypes)) {
      Node node = number_node(number->number, f.count);
      const bool beside_names =
          f.array && !place.in_array && (f.count == Node::kCounted || f.count == listed);
      node.names = beside_names ? place.names : -1;
      const bool nested = place.in_array && f.array;
      if (place.is_field && !nested && f.count <= static_cast<std::int64_t>(kMostOfField)) {
        node.field = static_cast<int>(to_.fields_.size());
        to_.fields_.push_back({place.begin, place.end, f.array || place.in_array, node.names});
      }
      return node;
    }
    if (f.type == "string") {
      Node node;
      node.kind = Node::Kind::kText, node.count = f.count;
      return node;
    }
    if (f.type == "wstring") fail("has a wstring, which is not read: {}", f.name);
    if (f.array) {
      place.is_field = place.is_field && !place.in_array;
      place.in_array = true;
      place.names = -1;
    }
    Node node = structure(full_name(f.type, type), std::move(place));
    node.count = f.count;
    return node;
  }

  // of a type that may be of the package of the one that names it
  static std::string full_name(const std::string& type, const std::string& within) {
    if (type.find('/') != type.npos) return type;
    return within.substr(0, within.find('/') + 1) + type;
  }

  RosType& to_;
  detail::Definitions definitions_;
  std::vector<std::string> within_;
  std::size_t nodes_ = 0;
};

namespace {

// whose numbers are read
class MessageWalk {
 public:
  MessageWalk(Cdr& cdr, MessageNumbers& to) : cdr_(cdr), to_(to) {}

  const char* objection() const {
    return why_ != nullptr ? why_ : cdr_.cut_off() ? kCutOff : nullptr;
  }

  template <class Node>
  void take(const Node& n) {
    const std::uint64_t count =
        n.count == Node::kCounted ? cdr_.count() : static_cast<std::uint64_t>(n.count);
    if (n.kind == Node::Kind::kNumber) return take_numbers(n, count);
    const bool listed = n.kind == Node::Kind::kText && n.names >= 0;
    if (listed && count > kMostJoints) why_ = "it has more than 64 joints";
    for (std::uint64_t i = 0; i < count && objection() == nullptr; ++i) {
      if (listed) {
        take_name(to_.names[static_cast<std::size_t>(n.names)]);
      } else if (n.kind == Node::Kind::kText) {
        cdr_.text();
      } else {
        for (const Node& f : n.fields) take(f);
      }
    }
  }

 private:
  static constexpr const char* kCutOff = "it is cut off";

  template <class Node>
  void take_numbers(const Node& n, std::uint64_t count) {
    if (objection() != nullptr) return;
    if (n.names >= 0) {
      const std::size_t names = to_.names[static_cast<std::size_t>(n.names)].size();
      if (names != 0 && count != 0 && count != names) why_ = "it has not as many numbers as names";
    }
    if (n.field < 0 || count > kMostOfField || why_ != nullptr) return cdr_.skip(n.number, count);
    cdr_.numbers(n.number, count, to_.numbers[static_cast<std::size_t>(n.field)]);
  }

  void take_name(std::vector<std::string>& names) {
    const std::string_view name = cdr_.text();
    if (cdr_.cut_off()) return;
    if (std::find(names.begin(), names.end(), name) != names.end()) why_ = "it names a joint twice";
    names.emplace_back(name);
  }

  Cdr& cdr_;
  MessageNumbers& to_;
  const char* why_ = nullptr;
};

}  // namespace

void BagMessageType::clear(MessageNumbers& to) const {
  to.names.resize(lists_), to.numbers.resize(fields_.size());
  for (auto& names : to.names) names.clear();
  for (auto& numbers : to.numbers) numbers.clear();
}

const char* BagMessageType::objection_to(const MessageNumbers& numbers) const {
  for (std::size_t i = 0; i < fields_.size(); ++i) {
    const std::size_t count = numbers.numbers[i].size();
    if (fields_[i].names >= 0 && count != 0 &&
        count != numbers.names[static_cast<std::size_t>(fields_[i].names)].size())
      return "it has not as many numbers as names";
  }
  return nullptr;
}

RosType::RosType(const std::string& name, std::string_view definition) {
  const std::string type = short_type_name(name);
  if (is_joint_state(name)) definition = kBuiltIn;
  exact_ = !is_joint_state(name);
  MessageCompiler compiler(*this, read_definitions(type, definition));
  root_ = std::make_unique<Node>(compiler.structure(type, {}));
}

RosType::~RosType() = default;

bool RosType::is_joint_state(std::string_view name) {
  return short_type_name(name) == kRootOfBuiltIn;
}

const char* RosType::read(std::string_view bytes, MessageNumbers& to) {
  if (const char* why = objection_to_encapsulation(bytes)) return why;
  clear(to);
  Cdr cdr(bytes.substr(kEncapsulation), bytes[1] == 0);
  MessageWalk walk(cdr, to);
  walk.take(*root_);
  if (const char* why = walk.objection()) return why;
  const auto empty = [](const auto& names) { return names.empty(); };
  if (lists_ > 0 && std::all_of(to.names.begin(), to.names.end(), empty))
    return "it names no joint";
  if (const char* why = objection_to(to)) return why;
  return exact_ && cdr.left() > kMostPadding ? "it is longer than its definition says" : nullptr;
}

}  // namespace tauext
