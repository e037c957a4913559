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

/** Changes when this struct does, or what CMake leaves beside a plug-in; those of different numbers
 * are not compared. */
#define TAUEXT_PLUGIN_ABI 3

/** So many steps of an instance, one a sample; begins anew (with a reset) after the last sample,
 * and where a sample's t is 0. */
typedef void (*tauext_run)(void* instance, int steps);

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
  /** Writes n samples of an arm's life (bench/kit/life.h), another one for each seed. */
  void (*life)(int kernel, unsigned seed, int n, double* samples);
  /** Bytes of a sample as the kernel reads it. */
  int (*sample_bytes)(int kernel);
  /** Makes what the kernel reads out of n samples; `out` is aligned to 64 bytes. */
  void (*unpack)(int kernel, int n, const double* samples, void* out);
  /** A fresh kernel at work on n samples that unpack() made, which are read alone and must outlive
   * it; to be given to destroy. NULL: out of memory. */
  void* (*create)(int kernel, int n, const void* unpacked);
  /** What runs an instance of that kernel: all that is timed. */
  tauext_run (*runner)(int kernel);
  /** Copies at most so many bytes of an instance's subject, its parameters and its memory, and
   * gives their number; 0 if it owns memory elsewhere, of which they say nothing. Padding is 0,
   * where the compiler can tell. */
  int (*state)(void* instance, int most, void* bytes);
  /** What create() made. */
  void (*destroy)(void* instance);
};

/** The one symbol that a plug-in exports. */
#define TAUEXT_PLUGIN_SYMBOL "tauext_get_plugin"

#ifdef __cplusplus
}
#endif
