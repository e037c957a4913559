// SPDX-License-Identifier: Apache-2.0
/// @file
/// Loads a plug-in (bench/kit/plugin.h) and runs its kernels.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
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
  /// Where a kernel's code begins, as an address of the file.
  std::uint64_t address(int kernel) const;

 private:
  void require_different_names(const std::string& path) const;

  std::shared_ptr<void> library_;
  const tauext_plugin* api_;
};

/// Samples of an arm's life as a kernel reads them.
class Samples {
 public:
  /// Another life for each seed.
  Samples(const Plugin& plugin, int kernel, unsigned seed, int n);
  /// The same life as another plug-in's kernel reads it.
  /// @throws std::runtime_error if that has another number of joints
  Samples(const Plugin& plugin, int kernel, const Samples& same);

  int count() const { return count_; }
  /// Doubles: t, q, qd, tau and tau_ext of each sample.
  const std::vector<double>& plain() const { return *plain_; }
  const void* unpacked() const { return unpacked_.get(); }

 private:
  void unpack(const Plugin& plugin, int kernel);

  int count_;
  std::size_t bytes_ = 0;
  std::shared_ptr<const std::vector<double>> plain_;
  std::shared_ptr<const void> unpacked_;
};

/// The samples of many kernels: one life for each robot, the first kernel's, whatever the plug-in.
class Lives {
 public:
  Lives(unsigned seed, int n) : seed_(seed), n_(n) {}
  const Samples& of(const Plugin& plugin, int kernel);

 private:
  using Robot = std::pair<std::string, int>;  // name, doubles of a sample

  unsigned seed_;
  int n_;
  std::map<Robot, Samples> first_;
  std::map<std::pair<const tauext_plugin*, Robot>, Samples> read_;
};

/// A kernel at work on such samples, which it shares with others.
class Work {
 public:
  Work(const Plugin& plugin, int kernel, Samples samples);
  void run(int steps) { run_(instance_.get(), steps); }
  /// The bytes of what it works with; "" if they are not all of it.
  std::string state() const;

 private:
  const tauext_plugin* api_;
  Samples samples_;
  tauext_run run_;
  std::unique_ptr<void, void (*)(void*)> instance_;
};

}  // namespace tauext::gate
