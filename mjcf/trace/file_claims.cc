// SPDX-License-Identifier: Apache-2.0
#include "mjcf/trace/file_claims.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

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
  // an input with a descriptor that keeps its number from being given to another file
  std::vector<std::pair<Identity, int>> inputs;
  std::vector<Identity> outputs;
};

Claims& claims() {
  static Claims all;
  return all;
}

Identity identity(const struct stat& file) {
  return {file.st_dev, file.st_ino};
}

auto input(Claims& c, const struct stat& file) {
  return std::find_if(c.inputs.begin(), c.inputs.end(),
                      [&](const auto& known) { return known.first == identity(file); });
}

auto output(Claims& c, const struct stat& file) {
  return std::find(c.outputs.begin(), c.outputs.end(), identity(file));
}

}  // namespace

void add_input(const struct stat& file, const std::string& path) {
  Claims& c = claims();
  const std::lock_guard lock(c.mutex);
  if (output(c, file) != c.outputs.end()) {
    throw std::runtime_error(
        fmt::format("{}: it is to be read, and an output of this program is to replace it", path));
  }
  if (input(c, file) != c.inputs.end()) return;
  c.inputs.emplace_back(identity(file), ::open(path.c_str(), O_PATH | O_CLOEXEC));
}

void add_output(const struct stat& file, const std::string& path) {
  Claims& c = claims();
  const std::lock_guard lock(c.mutex);
  if (input(c, file) != c.inputs.end()) {
    throw std::runtime_error(
        fmt::format("{}: is read by this program; write to another file", path));
  }
  c.outputs.push_back(identity(file));
}

void drop_input(const struct stat& file) {
  Claims& c = claims();
  const std::lock_guard lock(c.mutex);
  const auto it = input(c, file);
  if (it == c.inputs.end()) return;
  ::close(it->second);
  c.inputs.erase(it);
}

void drop_output(const struct stat& file) {
  Claims& c = claims();
  const std::lock_guard lock(c.mutex);
  const auto it = output(c, file);
  if (it != c.outputs.end()) c.outputs.erase(it);
}

}  // namespace tauext::claims
