// SPDX-License-Identifier: Apache-2.0
#include "regression/code/layouts.h"

#include <fmt/format.h>

#include <future>
#include <random>

namespace tauext::gate {

Layouts::Layouts(const std::string& base, const std::string& head)
    : base_(base), head_(head), names_(paired_names(base_, head_)) {}

Layouts Layouts::only_moved(const std::string& base, std::uint64_t number) {
  Layouts layouts(base, base);
  std::mt19937_64 random(number);
  for (const auto& [name, shape] : layouts.base_.shapes()) {
    if (random() % 2 == 0) layouts.names_[name] = fmt::format("{} of {}", name, number);
  }
  return layouts;
}

void Layouts::write(std::uint64_t seed, const std::string& base, const std::string& head) const {
  auto beside = std::async(std::launch::async, [&] { base_.lay_out(seed, LayoutNames(), base); });
  head_.lay_out(seed, names_, head);
  beside.get();
}

}  // namespace tauext::gate
