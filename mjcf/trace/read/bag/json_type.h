// SPDX-License-Identifier: Apache-2.0
/// @file
/// Messages of numbers that are written as JSON, and say themselves what they hold.
#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "mjcf/trace/read/bag/message_type.h"

namespace tauext {

/// A type that messages tell: what any of them had is a field, whatever a schema says.
///
/// Numbers, true (1) and false (0) are fields, and arrays of them; null is NaN. Of an array of
/// objects each has its number in the path, as in RosType. Arrays in arrays, arrays of more than
/// 256 numbers, paths of more than 200 letters and texts are none. A list of joints' names is an
/// array of texts that is called `joint_names` or `name`; it says whose the numbers are in the
/// arrays beside it, and in the objects beside it.
class JsonType final : public BagMessageType {
 public:
  /// @throws std::runtime_error naming the package, if RapidJSON was missing at build
  JsonType();

  bool learns() const override { return true; }
  const char* read(std::string_view bytes, MessageNumbers& to) override;

 private:
  friend class JsonWalk;
  static constexpr int kNone = -1;

  // what has a path
  struct Node {
    std::string key, begin, end;  // the last two are its path, as MessageField has them
    int parent = kNone;
    bool in_array = false;
    std::map<std::string, int, std::less<>> members;
    std::vector<int> order;   // the same, as messages have them
    int elements = kNone;     // what the objects of an array are
    int one = kNone;          // of fields(): a number
    int many = kNone;         // an array of them
    int list = kNone;         // of joints' names that is a member
    int list_member = kNone;  // which of them
  };

  Node& at(int node) { return nodes_[static_cast<std::size_t>(node)]; }
  int add_node(int parent, std::string_view key);
  int member(int node, std::string_view key, std::size_t expected);
  int elements_of(int array);
  int field_of(int node, bool many);
  int list_of(int array);
  int list_above(int node);

  std::vector<Node> nodes_;       // the first is the whole message
  std::vector<int> field_nodes_;  // of each field
};

}  // namespace tauext
