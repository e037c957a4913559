// SPDX-License-Identifier: Apache-2.0
/// @file
/// tauext-bench as a function, for a program that registers something of its own first.
#pragma once

namespace tauext {

/// Scores, then times every entry inside Google Benchmark, and prints tables; with
/// --equal-bandwidth or --pareto one of the studies instead. The flags are those of
/// tauext-bench; after the word `detect`, those of tauext-detect (detect_main.h).
/// @returns the exit code: 0 good, 1 an entry failed, 2 could not run
int bench_main(int argc, char** argv);

}  // namespace tauext
