// SPDX-License-Identifier: Apache-2.0
/// @file
/// Loads a plug-in (bench/kit/plugin.h) and runs its kernels.
#pragma once

#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "bench/kit/plugin.h"

namespace tauext::gate {

/// A plug-in of another tauext_plugin than ours.
struct OtherAbi : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// A loaded plug-in. Two of the same path would be one and the same: give each a copy of its own.
class Plugin {
 public:
  /// @throws OtherAbi; std::runtime_error naming the path: no plug-in, or two kernels of one name
  /// @param shown the path for errors, if it is a copy that is loaded
  explicit Plugin(const std::string& path, const std::string& shown = "");

  int count() const { return api_->count; }
  std::string name(int kernel) const { return api_->name(kernel); }
  /// Its number, -1 if it has no kernel of that name.
  int find(const std::string& name) const;
  const tauext_plugin& api() const { return *api_; }

 private:
  void require_different_names(const std::string& path) const;

  std::shared_ptr<void> library_;
  const tauext_plugin* api_;
};

/// One second of samples, of a kernel's own making.
std::vector<double> example(const Plugin& plugin, int kernel);
inline constexpr int kExampleSamples = 1000;

/// A kernel at work on such samples.
class Work {
 public:
  Work(const Plugin& plugin, int kernel, const std::vector<double>& samples);
  void run(int steps) { api_->run(instance_.get(), steps); }

 private:
  const tauext_plugin* api_;
  std::unique_ptr<void, void (*)(void*)> instance_;
};

}  // namespace tauext::gate
