// SPDX-License-Identifier: Apache-2.0
/// @file
/// Other work between two steps, after which caches and predictors know nothing of a kernel.
#pragma once

namespace tauext::gate {

/// Reads and writes 2 MB, and takes 8192 branches at random. [about 0.2 ms]
void do_other_work();

}  // namespace tauext::gate
