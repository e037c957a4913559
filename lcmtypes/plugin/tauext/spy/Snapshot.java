// SPDX-License-Identifier: Apache-2.0
package tauext.spy;

import java.util.List;

/** What a window draws: a copy, so that drawing keeps no message waiting. */
final class Snapshot {
  int n;                // [1] joints; 0 before the first message
  byte reference;       // as in estimate_t
  double t0;            // [s] left edge
  double t1;            // [s] right edge
  double base;          // [s] subtracted from the times shown: not 0 if the sender's clock is a calendar's
  Columns[] truth;      // [N m] per joint
  Columns[] estimate;   // [N m] per joint
  Columns contact;      // [1] 1 while a collision acts, as the simulation knows
  List<Mark> marks;
  Counters counters;
  double longest_us;    // [us] the longest step in the window; NaN without one
}
