// SPDX-License-Identifier: Apache-2.0
#include "bench/roster/making.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <stdexcept>
#include <typeindex>

namespace tauext::detail {

std::vector<Registered>& registered_specifications() {
  static std::vector<Registered> all;
  return all;
}

std::shared_ptr<void>& registered_of(const std::type_info& functions) {
  static std::map<std::type_index, std::shared_ptr<void>> all;
  return all[functions];
}

void fail_truth(const std::string& estimator) {
  throw std::invalid_argument(
      fmt::format("estimator '{}' copies the truth: it needs columns tau_ext1..", estimator));
}

std::optional<double> take_bandwidth(Specification& s) {
  const auto key = std::find_if(s.keys.begin(), s.keys.end(),
                                [](const auto& k) { return k.first == "bandwidth"; });
  if (key == s.keys.end()) return std::nullopt;
  const double w = number_of("bandwidth", key->second, kLeastBandwidth, kMostBandwidth);
  s.keys.erase(key);
  return w;
}

FieldHelp bandwidth_help() {
  return {"bandwidth", "rad/s", range_of(kLeastBandwidth, kMostBandwidth),
          "larger is faster, noisier; sets the others", ""};
}

}  // namespace tauext::detail
