// SPDX-License-Identifier: Apache-2.0
package tauext.spy;

import java.util.ArrayDeque;
import java.util.ArrayList;
import tauext.detection_t;
import tauext.estimate_t;
import tauext.summary_t;

/**
 * The last ten seconds of one channel of estimates, and of the detections that belong to it. Sign of the
 * torques [N m]: B qdd + C qd + F + g + tau_ext = tau. LCM's thread adds, Swing's takes snapshots.
 */
final class Recording {
  static final int kJoints = 8;
  private static final int kMarks = 1000;
  private static final long kNever = Long.MIN_VALUE / 2;
  private static final long kLate_us = 500000;  // a detector may be that far behind another one

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
  private final Sequence sequence = new Sequence();
  private int others;  // messages in a row of another number of joints

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
    ++version;
    if (last != null && m.n != last.n && ++others < Sequence.kPatience) {
      sequence.excuse(m.seq);
      reject();
      return;
    }
    others = 0;
    Sequence.Order order = sequence.take(m.seq);
    if (order == Sequence.Order.LATE || order == Sequence.Order.REPEATED) {
      return;
    }
    if (last != null && (order == Sequence.Order.RESTART || m.n != last.n || m.utime < last.utime)) {
      restart();
    }
    if (last == null) {
      begin_us = m.utime;
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
    ++counters.rejected;
  }

  /** The sender's summary: the last messages may have been lost, too. */
  synchronized void end(summary_t s) {
    boolean alone = s.entry.endsWith("/" + estimator);
    long all = s.published + s.failed;
    if (estimator.isEmpty() || impossible(s.published) || impossible(s.failed) || all == 0
        || !alone && !s.entry.contains("/" + estimator + "+")) {
      return;
    }
    ++version;
    sequence.end(alone ? all : all / 2);  // with a detector, an estimate and a detection each time
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
    s.counters.used = sequence.next;
    s.counters.late = sequence.late;
    s.counters.repeated = sequence.repeated;
    s.counters.rejected += sequence.foreign;
    s.counters.lost = sequence.lost;
    s.longest_us = new Columns(step, end, 1).max();
    return s;
  }

  private void count(estimate_t m) {
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
