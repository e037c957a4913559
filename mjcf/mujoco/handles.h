// SPDX-License-Identifier: Apache-2.0
/// @file
/// What MuJoCo has made, owned; and what is asked of it everywhere.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>

// MuJoCo's own names; its header is included in the sources that call it alone
struct mjModel_;
struct mjData_;
using mjModel = mjModel_;  ///< MuJoCo's model
using mjData = mjData_;    ///< MuJoCo's state of a model

namespace tauext {

/// A loaded model, shared and read-only: safe to use from many threads, one Plant each.
using Model = std::shared_ptr<const mjModel>;

/// Takes a model over, which may be null.
Model owned(mjModel* m);

/// Calls mj_deleteData.
struct DeleteState {
  void operator()(mjData* d) const;  ///< the deleter's operator
};
/// A state of a model, with all that MuJoCo computes from it.
using State = std::unique_ptr<mjData, DeleteState>;

/// The model at its initial state, after mj_forward.
State initial_state(const mjModel& m);

/// Its inertia [kg m^2] or [kg] over all degrees of freedom, at a state whose positions are known.
Eigen::MatrixXd mass_matrix(const mjModel& m, const mjData& d);

/// The name of an element of one of MuJoCo's kinds (mjtObj), to be printed; "" if it has none.
std::string element_name(const mjModel& m, int kind, int id);

/// A hinge or slide by its number, from 1, and its name: "joint 3 'elbow'".
std::string joint_name(const mjModel& m, int joint);

/// MuJoCo's version, like "2.2.2".
std::string mujoco_version();

}  // namespace tauext
