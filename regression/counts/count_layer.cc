// SPDX-License-Identifier: Apache-2.0
#include "regression/counts/count_layer.h"

#include <fmt/format.h>

#include <filesystem>
#include <regex>
#include <stdexcept>
#include <system_error>

#include "regression/counts/instructions.h"

namespace tauext::gate {
namespace {

// of a folder
struct OtherKeys {
  std::string text;           // every key that it has, and in what it differs
  bool same_machine = false;  // one is of this machine, and differs in what we chose
};

OtherKeys other_keys(const std::string& folder, const Key& key) {
  OtherKeys others;
  std::error_code missing;  // a folder that is not there holds no other key
  for (const auto& entry : std::filesystem::directory_iterator(folder, missing)) {
    const std::string name = entry.path().filename().string();
    if (!name.starts_with("instructions-")) continue;
    const Key other = read_counts(entry.path()).key;
    others.text += fmt::format("\n    {} has {}", name, key_difference(other, key));
    const auto same = [&](const char* what) { return other.at(what) == key.at(what); };
    others.same_machine |= same("arch") && same("compiler") && same("glibc") && same("libm");
  }
  return others;
}

void compare_with_committed(const CountOptions& o, InstructionReport& r) {
  const std::optional<Counts> committed = committed_counts(o.baselines, r.head->key);
  if (!committed) {
    const Key& key = r.head->key;
    const OtherKeys others = other_keys(o.baselines, key);
    if (r.base && r.other_key.empty() && !others.text.empty() && !others.same_machine) {
      r.only_base = fmt::format(
          "no baseline for {} with glibc {}; counts are compared between base and head alone{}",
          key.at("compiler"), key.at("glibc"), others.text);
    } else {
      r.no_baseline = fmt::format("no baseline for this key: {} is not there{}",
                                  counts_path(o.baselines, key), others.text);
    }
    return;
  }
  const std::regex wanted(o.kernels);
  r.beside_committed = compare_counts(*committed, *r.head);
  for (const auto& [kernel, count] : r.head->kernels) {
    if (!committed->kernels.contains(kernel)) r.added.push_back(kernel);
  }
  for (const auto& [kernel, count] : committed->kernels) {
    if (std::regex_search(kernel, wanted) && !r.head->kernels.contains(kernel)) {
      r.gone.push_back(kernel);
    }
  }
}

}  // namespace

bool InstructionReport::compared(const std::string& kernel) const {
  return base && other_key.empty() && base->kernels.contains(kernel);
}

InstructionReport compare_instructions(const CountOptions& o) {
  InstructionReport r;
  if (o.progress) o.progress("counting instructions");
  r.head = count_instructions(o.head, o.kernels);
  r.kernels = static_cast<int>(r.head->kernels.size());
  if (!o.base.empty()) r.base = count_instructions(o.base, o.kernels);
  if (r.head->kernels.empty() && (!r.base || r.base->kernels.empty())) {
    throw std::invalid_argument(fmt::format("--kernels '{}' matches no kernel", o.kernels));
  }
  if (r.base && r.base->key == r.head->key) {
    r.beside_base = compare_counts(*r.base, *r.head);
  } else if (r.base) {
    r.other_key = key_difference(r.base->key, r.head->key);
  }
  compare_with_committed(o, r);
  return r;
}

}  // namespace tauext::gate
