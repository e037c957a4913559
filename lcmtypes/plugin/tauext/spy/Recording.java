// SPDX-License-Identifier: Apache-2.0
package tauext.spy;

import java.util.ArrayDeque;
import java.util.ArrayList;
import tauext.detection_t;
import tauext.estimate_t;

/**
 * The last ten seconds of one channel of estimates, and of the detections that belong to it. Sign of the
 * torques [N m]: B qdd + C qd + F + g + tau_ext = tau. LCM's thread adds, Swing's takes snapshots.
 */
final class Recording {
  static final int kJoints = 8;
  private static final int kMarks = 1000;
  private static final long kNever = Long.MIN_VALUE / 2;
  private static final long kLate_us = 500000;  // a detector may be that far behind another one
  private static final int kPatience = 20;  // messages
  private static final long kLargestLoss = 10000;  // messages; a larger jump is another sender

  private final String estimator;
  private final Series[] truth = new Series[kJoints];
  private final Series[] estimate = new Series[kJoints];
  private final Series step = new Series();
  private final Series contact = new Series();
  private final ArrayDeque<Mark> marks = new ArrayDeque<>();
  private final Counters counters = new Counters();
  private estimate_t last;  // null: none since the last clear()
  private long begin_us;
  private long detection_us = kNever;
  private long version;
  private int behind;  // messages in order that are older than `last`
  private long behind_us;

  /** Takes the detections of this estimator; of all estimators if it is "". */
  Recording(String estimator) {
    this.estimator = estimator;
    for (int i = 0; i < kJoints; ++i) {
      truth[i] = new Series();
      estimate[i] = new Series();
    }
  }

  synchronized void add(estimate_t m) {
    if (m.n < 1 || m.n > kJoints || impossible(m.utime) || impossible(m.seq)) {
      reject();
      return;
    }
    if (last != null && (m.utime < last.utime || m.seq < last.seq || m.n != last.n)) {
      // late, or another sender's; many in order are a sender that has started anew
      behind = behind > 0 && m.utime > behind_us ? behind + 1 : 1;
      behind_us = m.utime;
      if (behind < kPatience) {
        ++version;
        ++counters.late;
        return;
      }
      restart();
    }
    behind = 0;
    if (last == null) {
      begin_us = m.utime;
    } else if (m.seq > last.seq + 1 && m.seq - last.seq <= kLargestLoss) {
      counters.lost += m.seq - last.seq - 1;
    }
    for (int i = 0; i < m.n; ++i) {
      estimate[i].add(m.utime, m.tau_ext_hat[i], m.tau_ext_hat_min[i], m.tau_ext_hat_max[i]);
      if (m.reference != estimate_t.kNone) {
        truth[i].add(m.utime, m.tau_ext_true[i], m.tau_ext_true_min[i], m.tau_ext_true_max[i]);
      }
    }
    step.add(m.utime, m.step_us, m.step_us, m.step_us);
    count(m);
    last = m;
  }

  /** Of a time [us] or a number: as in wire.h. */
  private static boolean impossible(long value) {
    return value < 0 || value > 1L << 53;
  }

  synchronized void add(detection_t d) {
    if (impossible(d.utime) || impossible(d.mark_utime)) {
      reject();
      return;
    }
    if (!estimator.isEmpty() && !estimator.equals(d.estimator)) {
      return;
    }
    ++version;
    if (d.utime < detection_us - kLate_us) {
      return;  // late, or of a stream that begins anew, which the estimates will tell
    }
    detection_us = d.utime;
    contact.add(d.utime, d.contact_true, d.contact_true, d.contact_true);
    if (d.mark != 0 && marks.stream().noneMatch(new Mark(d)::same)) {
      marks.add(new Mark(d));
      if (marks.size() > kMarks) {
        marks.remove();
      }
    }
  }

  synchronized void reject() {
    ++version;
    ++counters.malformed;
  }

  /** Grows with whatever arrives. */
  synchronized long version() {
    return version;
  }

  /** The window as a chart so many pixels wide draws it. */
  synchronized Snapshot snapshot(int width) {
    Snapshot s = new Snapshot();
    s.n = last == null ? 0 : last.n;
    s.reference = last == null ? estimate_t.kNone : last.reference;
    long end = last == null ? Series.kWindow_us : Math.max(begin_us + Series.kWindow_us, last.utime);
    s.t0 = 1e-6 * (end - Series.kWindow_us);
    s.t1 = 1e-6 * end;
    s.base = Math.abs(s.t1) < 1e5 ? 0 : 1000 * Math.floor(s.t0 / 1000);
    s.truth = new Columns[s.n];
    s.estimate = new Columns[s.n];
    for (int i = 0; i < s.n; ++i) {
      s.truth[i] = new Columns(truth[i], end, width);
      s.estimate[i] = new Columns(estimate[i], end, width);
    }
    s.contact = new Columns(contact, end, width);
    s.marks = new ArrayList<>(marks);
    s.marks.removeIf(m -> m.utime < end - Series.kWindow_us || m.utime > end);
    s.counters = counters.clone();
    s.longest_us = new Columns(step, end, 1).max();
    return s;
  }

  private void count(estimate_t m) {
    ++version;
    ++counters.messages;
    counters.status = m.status;
    counters.step_us = m.step_us;
    if (m.status != estimate_t.kOk && m.status != estimate_t.kStarted) {
      ++counters.failed;
      counters.failure = m.status;
      counters.failure_t = 1e-6 * m.utime;
    }
  }

  private void restart() {
    ++counters.restarts;
    for (int i = 0; i < kJoints; ++i) {
      truth[i].clear();
      estimate[i].clear();
    }
    step.clear();
    contact.clear();
    marks.clear();
    last = null;
    detection_us = kNever;
  }
}
