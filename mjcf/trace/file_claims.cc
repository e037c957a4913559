// SPDX-License-Identifier: Apache-2.0
#include "mjcf/trace/file_claims.h"

#include <fmt/format.h>

#include <algorithm>
#include <mutex>
#include <stdexcept>
#include <utility>
#include <vector>

namespace tauext::claims {
namespace {

using Identity = std::pair<dev_t, ino_t>;

struct Claims {
  std::mutex mutex;
  std::vector<Identity> inputs, outputs;
};

Claims& claims() {
  static Claims all;
  return all;
}

Identity identity(const struct stat& file) {
  return {file.st_dev, file.st_ino};
}

bool has(const std::vector<Identity>& all, const Identity& one) {
  return std::find(all.begin(), all.end(), one) != all.end();
}

void drop(std::vector<Identity> Claims::*which, const struct stat& file) {
  Claims& c = claims();
  const std::lock_guard lock(c.mutex);
  auto& all = c.*which;
  const auto it = std::find(all.begin(), all.end(), identity(file));
  if (it != all.end()) all.erase(it);
}

}  // namespace

void add_input(const struct stat& file, const std::string& path) {
  Claims& c = claims();
  const std::lock_guard lock(c.mutex);
  if (has(c.outputs, identity(file))) {
    throw std::runtime_error(
        fmt::format("{}: it is to be read, and an output of this program is to replace it", path));
  }
  if (!has(c.inputs, identity(file))) c.inputs.push_back(identity(file));
}

void add_output(const struct stat& file, const std::string& path) {
  Claims& c = claims();
  const std::lock_guard lock(c.mutex);
  if (has(c.inputs, identity(file))) {
    throw std::runtime_error(
        fmt::format("{}: is read by this program; write to another file", path));
  }
  c.outputs.push_back(identity(file));
}

void drop_input(const struct stat& file) {
  drop(&Claims::inputs, file);
}

void drop_output(const struct stat& file) {
  drop(&Claims::outputs, file);
}

}  // namespace tauext::claims
