// SPDX-License-Identifier: Apache-2.0
package tauext.spy;

import java.util.ArrayDeque;

/**
 * The numbers of one sender's messages, as they arrive: each is counted once, and the sum of all counts is
 * what was sent. It judges as lcmtypes/receive/sequence.h does.
 */
final class Sequence {
  /** What a message's number says of it. */
  enum Order { NEXT, LATE, REPEATED, RESTART }

  static final int kPatience = 20;  // messages
  private static final long kSmall = 64;  // messages, which a network may have put in disorder
  private static final int kGaps = 64;

  long next;      // messages that came in turn
  long late;      // that were overtaken
  long repeated;  // that had come before
  long lost;      // that never came
  long foreign;   // that jumped ahead, and the stream did not follow
  long restarts;

  private boolean any;
  private boolean ended;
  private long expected;
  private long[] jump;  // {from, to}, not yet believed; null: none
  private final ArrayDeque<long[]> missing = new ArrayDeque<>();
  private final ArrayDeque<Long> excused = new ArrayDeque<>();
  private int behind;  // in order, since the last that was next
  private int behindLate;
  private long lastBehind;

  Order take(long seq) {
    if (!any) {
      any = true;
      expected = seq;
    }
    if (ended && seq < expected - 1 && missing.stream().noneMatch(g -> seq >= g[0] && seq < g[1])) {
      return restart(seq);
    }
    ended = ended && seq < expected;
    if (jump != null && seq >= jump[0] && seq < Math.min(jump[1], jump[0] + kSmall)) {
      refuseJump();
    }
    return seq >= expected ? takeAhead(seq) : takeBehind(seq);
  }

  /** A message of that number came and was no good: it is not lost. */
  void excuse(long seq) {
    if (fill(seq) || seq < expected || excused.contains(seq)) {
      return;
    }
    excused.add(seq);
    if (excused.size() > kGaps) {
      excused.remove();
    }
  }

  /** The sender says that it has ended, and that its numbers ended before this one. */
  void end(long count) {
    if (jump != null && count <= jump[1]) {
      refuseJump();
    }
    if (!any || count < expected) {
      return;
    }
    settleJump();
    miss(expected, count);
    expected = count;
    ended = true;
  }

  private Order takeAhead(long seq) {
    if (jump != null && seq - expected > kSmall) {
      refuseJump();  // nor did it go on from there
    }
    settleJump();
    if (seq - expected > kSmall) {
      jump = new long[] {expected, seq};
    } else {
      miss(expected, seq);
    }
    expected = seq + 1;
    behind = behindLate = 0;
    ++next;
    return Order.NEXT;
  }

  private Order takeBehind(long seq) {
    if (behind == 0 || seq <= lastBehind) {
      behind = behindLate = 0;
    }
    ++behind;
    lastBehind = seq;
    boolean wasMissing = fill(seq);
    if (wasMissing) {
      ++behindLate;
      ++late;
    } else {
      ++repeated;
    }
    if (behind < kPatience) {
      return wasMissing ? Order.LATE : Order.REPEATED;
    }
    // none of them was what it seemed
    lost += behindLate;
    late -= behindLate;
    repeated -= behind - behindLate;
    next += behind - 1;
    return restart(seq);
  }

  private Order restart(long seq) {
    missing.clear();
    excused.clear();
    jump = null;
    any = true;
    ended = false;
    expected = seq + 1;
    behind = behindLate = 0;
    ++restarts;
    ++next;
    return Order.RESTART;
  }

  private void settleJump() {
    if (jump != null) {
      miss(jump[0], jump[1]);
      jump = null;
    }
  }

  /** The old stream goes on: what jumped was another's. */
  private void refuseJump() {
    expected = jump[0];
    jump = null;
    --next;
    ++foreign;
  }

  private void miss(long from, long to) {
    if (from >= to) {
      return;
    }
    lost += to - from;
    keep(from, to);
    for (long seq : excused) {
      if (seq >= from && seq < to) {
        fill(seq);
      }
    }
  }

  private void keep(long from, long to) {
    missing.add(new long[] {from, to});
    if (missing.size() > kGaps) {
      missing.remove();
    }
  }

  private boolean fill(long seq) {
    for (long[] gap : missing) {
      if (seq >= gap[0] && seq < gap[1]) {
        missing.remove(gap);
        if (gap[0] < seq) {
          keep(gap[0], seq);
        }
        if (seq + 1 < gap[1]) {
          keep(seq + 1, gap[1]);
        }
        --lost;
        return true;
      }
    }
    return false;
  }
}
