// SPDX-License-Identifier: Apache-2.0
#include "bench/replay/robot_log.h"

#include <utility>

#include "bench/replay/torque_fit.h"

namespace tauext {

RecordedLog robot_log(const Robot& robot, const std::string& path, const std::string& channel,
                      const std::string& columns, std::shared_ptr<const ContactsFile> contacts) {
  RecordedLog log =
      read_any_log(path, {channel, columns, robot.joints(), true, std::move(contacts)});
  robot.require_joints(log.trace, path);
  const bool without_gravity = log.trace.tau_without_gravity;
  robot.make_torques(log.trace);
  if (robot.is_from_file())
    log.doubtful |= !torques_fit(tree_of(robot.model()), {log.trace}, without_gravity, {path});
  return log;
}

}  // namespace tauext
