// SPDX-License-Identifier: Apache-2.0
/// @file
/// A robot as a picture, drawn by MuJoCo without a screen.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "mjcf/plant/model.h"

namespace tauext {

/// Where one looks from.
struct View {
  std::string camera;      ///< of the model; "": turned as below, towards the robot's middle
  double azimuth = 130;    ///< [degrees] of the direction in which one looks, from x to y
  double elevation = -20;  ///< [degrees] above the horizon; looking down is negative
  int width = 1200;        ///< [pixels], 16 to 4096
  int height = 900;        ///< [pixels], 16 to 4096
};

/// The names of a robot's cameras.
std::vector<std::string> cameras_of(const Model& robot);

/// Draws the robot in a pose q [rad] or [m] and writes a PNG; the file appears whole or not at all.
/// A robot without shapes is drawn as boxes of the same inertia, and its joints.
/// @throws std::invalid_argument for a q of another length, a size out of range and an unknown
/// camera, listing the known ones; std::runtime_error naming the path, or the Debian package that
/// was missing when this was built
void write_picture(const Model& robot, const Eigen::VectorXd& q, const View& view,
                   const std::string& path);

}  // namespace tauext
