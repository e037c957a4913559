// SPDX-License-Identifier: Apache-2.0
// An arm of any number of joints, as MJCF.
#pragma once

#include <fmt/format.h>

#include <string>

namespace tauext::test {

// an arm of n hinges about z and y in turn, in space, with rotors and friction; position servos
// instead of motors make it one that can only be watched
inline std::string hinge_arm(int n, bool motors = true) {
  std::string bodies, ends, actuators;
  for (int j = 1; j <= n; ++j) {
    bodies += fmt::format(
        "<body pos='0 0 0.3'><joint name='j{0}' axis='{1}' damping='0.4' armature='0.1'/>"
        "<geom type='capsule' fromto='0 0 0 0.05 0.02 0.3' size='0.05' mass='{2}'/>",
        j, j % 2 == 1 ? "0.3 0 1" : "0 1 0.2", 4.0 / j);
    ends += "</body>";
    actuators += motors ? fmt::format("<motor joint='j{}'/>", j)
                        : fmt::format("<position joint='j{}' kp='100'/>", j);
  }
  return "<mujoco><option integrator='RK4' timestep='0.001'/><worldbody>" + bodies +
         "<site name='end_effector' pos='0 0 0.3'/>" + ends + "</worldbody><actuator>" + actuators +
         "</actuator><contact/></mujoco>";
}

}  // namespace tauext::test
