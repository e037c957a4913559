// SPDX-License-Identifier: Apache-2.0
#include "bench/roster/file_robot.h"

#include <fmt/format.h>

#include <stdexcept>

#include "bench/roster/tree_robot.h"
#include "mjcf/import/robot_file.h"
#include "mjcf/plant/mjcf_file.h"
#include "mjcf/plant/remedy/doubts.h"
#include "mjcf/plant/tree.h"
#include "mjcf/trace/printable.h"

namespace tauext {
namespace {

static_assert(kMaxFileJoints <= kMostCoordinates);

void require_supported(int joints) {
  if (joints <= kMaxFileJoints) return;
  throw std::invalid_argument(fmt::format(
      "{} joints: 1 to {} are supported; --lock REGEX fixes others", joints, kMaxFileJoints));
}

}  // namespace

std::unique_ptr<const Robot> file_robot(const std::string& name) {
  const std::size_t lock = name.find(kLock);
  const std::string path = name.substr(0, lock);
  const ImportOptions options{lock == name.npos ? "" : name.substr(lock + kLock.size()), {}, false};
  std::string changes;
  const Model model = is_robot_file(name) ? load_mjcf(path, options, &changes) : load_robot(name);
  if (!changes.empty()) say(fmt::format("{}: {}", path, changes));
  try {
    const ArmTree arm = tree_of(model);
    if (const std::string doubts = doubts_about(*model); is_robot_file(name) && !doubts.empty())
      say(fmt::format("{}: {}", path, doubts));
    require_supported(arm.dof());
    return detail::tree_robot(arm.dof(), name, model);
  } catch (const std::invalid_argument& e) {
    std::string why = e.what();
    if (is_robot_file(name)) {
      const RobotFile file = robot_file(path, options);
      why = why_no_arm(why, file.path, {}, file.options);
      if (options.lock != file.options.lock)
        why += fmt::format("; {} has a \"lock\" of its own: replace that by this expression", path);
    }
    throw std::invalid_argument(fmt::format("{}: {}", path, why));
  }
}

}  // namespace tauext
