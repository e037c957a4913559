// SPDX-License-Identifier: Apache-2.0
/// @file
/// A load on its tether, in the hands of a scenario.
#pragma once

#include <optional>

#include "mjcf/scenarios/scenario_type.h"

namespace tauext::detail {

// hangs, pushes and drops the load when its time has come
class LoadHandler {
 public:
  explicit LoadHandler(const std::optional<Load>& load) : load_(load) {}

  template <class P>
  void apply(P& plant, double t) {
    if constexpr (requires { plant.hang_load(); }) {
      if (load_) handle(plant, t);
    }
  }

 private:
  template <class P>
  void handle(P& plant, double t) {
    const bool hang = t >= load_->hang_at && t < load_->drop_at;
    if (hang && !hung_) plant.hang_load();
    if (!hang && hung_) plant.drop_load();
    hung_ = hang;
    if (hung_ && load_->push) plant.push_load(load_->push(t));
  }

  const std::optional<Load>& load_;
  bool hung_ = false;
};

}  // namespace tauext::detail
