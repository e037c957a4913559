// SPDX-License-Identifier: Apache-2.0
// Traces bit for bit.
#pragma once

#include <gtest/gtest.h>

#include "mjcf/trace/trace.h"

namespace tauext::test {

// in all that a log holds
inline void expect_same(const Trace& a, const Trace& b) {
  EXPECT_EQ(a.t, b.t);
  EXPECT_EQ(a.q, b.q);
  EXPECT_EQ(a.qd, b.qd);
  EXPECT_EQ(a.tau, b.tau);
  EXPECT_EQ(a.tau_ext, b.tau_ext);
  EXPECT_EQ(a.contact, b.contact);
}

}  // namespace tauext::test
