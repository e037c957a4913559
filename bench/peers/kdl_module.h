// SPDX-License-Identifier: Apache-2.0
/// @file
/// What the module tauext_kdl.so offers. KDL's library was compiled for another alignment of
/// Eigen's arrays than ours, so that one must not free what the other has made: all that touches
/// KDL is in this module, and only types of fixed size go in and out.
#pragma once

namespace tauext::peers {

/// An EstimatorStage<>* that the caller deletes.
/// @param n joints: 3, 6 or 7
/// @param kind kName of an estimator in observers.h, or kdl_ekf
/// @param arm TreeModel<N>::Parameters of a chain
/// @param ekf EkfParameters<N> of kdl_ekf
/// @param w [rad/s] bandwidth of the others
/// @returns null for another n or kind
using MakeStage = void* (*)(int n, const char* kind, const void* arm, const void* ekf, double w);

/// Writes B (n x n) [kg m^2] and C qd + g [N m] of the arm at q [rad], qd [rad/s].
/// @returns false unless n is 3, 6 or 7
using Terms = bool (*)(int n, const void* arm, const double* q, const double* qd, double* B,
                       double* bias);

inline constexpr const char* kMakeStage = "tauext_kdl_make_stage";  ///< a MakeStage
inline constexpr const char* kTerms = "tauext_kdl_terms";           ///< a Terms

}  // namespace tauext::peers
