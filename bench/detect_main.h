// SPDX-License-Identifier: Apache-2.0
/// @file
/// tauext-detect as a function, for a program that registers something of its own first.
#pragma once

namespace tauext {

/// Calibrates the detectors of a robot, and studies every one of them behind every estimator. The
/// flags are those of tauext-detect; bench_main() is this function where the first of them is the
/// word `detect`.
/// @returns the exit code: 0 good, 1 recordings that thresholds cannot be set by, 2 could not run,
/// 130 ended by Ctrl-C
int detect_main(int argc, char** argv);

}  // namespace tauext
