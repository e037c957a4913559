/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * What tauext-gate sees of a build: its kernels (estimators, detectors, terms of a model) behind a
 * C ABI, so that two commits run in one process. bench/kit/kernels.h fills it in; nobody else needs
 * to.
 */
#pragma once

#ifdef __cplusplus
extern "C" {
#endif

/** Changes when this struct does; plug-ins of different numbers are not compared. */
#define TAUEXT_PLUGIN_ABI 1

/** A plug-in's kernels, numbered from 0. Functions neither throw nor print. */
struct tauext_plugin {  // NOLINT(readability-identifier-naming): a C name
  int abi;              /**< TAUEXT_PLUGIN_ABI */
  int count;            /**< of kernels */
  const char* compiler; /**< with its version */
  const char* flags;    /**< what the kernels were compiled with */
  const char* eigen;    /**< version */

  /** ROBOT/ESTIMATOR, ROBOT/DETECTOR or ROBOT/model.TERM; unique. */
  const char* (*name)(int kernel);
  /** Doubles a sample: t [s]; then q [rad], qd [rad/s], tau [N m], tau_ext [N m] of each joint. */
  int (*sample_size)(int kernel);
  /** Writes n samples 1 ms apart, of a moving arm with noisy sensors that is hit. */
  void (*example)(int kernel, int n, double* samples);
  /** A fresh kernel bound to copies of n samples; to be given to destroy. NULL: out of memory. */
  void* (*create)(int kernel, int n, const double* samples);
  /** So many steps, one a sample; begins anew (with a reset) after the last sample. */
  void (*run)(void* instance, int steps);
  /** What create() made. */
  void (*destroy)(void* instance);
};

/** The one symbol that a plug-in exports. */
#define TAUEXT_PLUGIN_SYMBOL "tauext_get_plugin"

#ifdef __cplusplus
}
#endif
