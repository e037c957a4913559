// SPDX-License-Identifier: Apache-2.0
// The source that a precompiled header hangs on.
