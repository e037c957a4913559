// SPDX-License-Identifier: Apache-2.0
/// @file
/// Base and head, laid out anew together.
#pragma once

#include <cstdint>
#include <string>

#include "regression/code/plugin_code.h"

namespace tauext::gate {

/// Pairs of layouts in which what both builds have lies at the same places.
class Layouts {
 public:
  /// @throws std::runtime_error as PluginCode does
  Layouts(const std::string& base, const std::string& head);
  /// A commit that changes nothing but where some of the functions lie: half of them, others for
  /// each number.
  static Layouts only_moved(const std::string& base, std::uint64_t number);

  /// Writes both, at once. @throws std::runtime_error as PluginCode::lay_out does
  void write(std::uint64_t seed, const std::string& base, const std::string& head) const;

  const PluginCode& base() const { return base_; }
  const PluginCode& head() const { return head_; }

 private:
  PluginCode base_, head_;
  LayoutNames names_;  // of head
};

}  // namespace tauext::gate
