// SPDX-License-Identifier: Apache-2.0
package tauext.spy;

import java.io.IOException;
import java.net.InetSocketAddress;
import java.util.Arrays;
import lcm.lcm.LCM;
import lcm.lcm.LCMDataInputStream;
import lcm.lcm.LCMDataOutputStream;
import lcm.lcm.LCMEncodable;
import tauext.detection_t;
import tauext.estimate_t;
import tauext.summary_t;

/** Claims about what lcm-spy's window draws, without a screen. Exits with 1 if one does not hold. */
public final class PluginTest {
  private static final String kChannel = "TAUEXT_ESTIMATE_ekf";
  private static final int kWidth = 600;  // [pixels] for 10 s: a pulse of 3 ms has a fifth of one
  private static int failures;

  private PluginTest() {}

  public static void main(String[] args) throws IOException {
    pulseOfThreeMillisecondsIsDrawn();
    aFastStreamKeepsItsPulses();
    restartClears();
    changedJointsClear();
    jumpOfSeqIsCounted();
    wrongJointsAreCountedAndIgnored();
    malformedMessagesAreCountedAndIgnored();
    marksOfOtherEstimatorsAreLeftOut();
    aClosedWindowHearsNothing();
    everyMessageIsAccountedFor();
    ofTwoSendersTheFirstIsShown();
    nonFiniteTorquesAreLeftOut();
    System.exit(failures > 0 ? 1 : 0);
  }

  private static void pulseOfThreeMillisecondsIsDrawn() {
    Recording recording = new Recording("ekf");
    for (int k = 0; k < 1600; ++k) {  // 200 Hz: the pulse lies between two messages
      estimate_t m = estimate(k, 5000L * k, 3);
      m.tau_ext_hat_max[1] = k == 900 ? 7 : 0;
      m.tau_ext_hat_min[2] = k == 1000 ? -5 : 0;
      recording.add(m);
    }
    Snapshot s = recording.snapshot(kWidth);
    expect(s.n == 3, "three joints are drawn");
    expect(s.estimate[1].hi[(int) (4.5 / 10 * kWidth)] == 7, "a pulse up is drawn at its time");
    expect(s.estimate[2].lo[(int) (5.0 / 10 * kWidth)] == -5, "a pulse down is drawn at its time");
    expect(s.estimate[0].max() == 0 && s.estimate[0].min() == 0, "a joint without pulse stays at rest");
  }

  private static void aFastStreamKeepsItsPulses() {
    Recording recording = new Recording("ekf");
    for (int k = 0; k < 120000; ++k) {  // 10 kHz for 12 s
      estimate_t m = estimate(k, 100L * k, 1);
      m.tau_ext_hat[0] = k == 30000 || k == 110000 ? 1 : 0;
      m.tau_ext_hat_max[0] = m.tau_ext_hat[0];
      recording.add(m);
    }
    Columns c = recording.snapshot(kWidth).estimate[0];
    expect(Arrays.stream(c.hi).filter(x -> x == 1).count() == 2, "one sample of 10 kHz is drawn");
    expect(c.has(0) && c.has(kWidth - 1), "the window holds ten seconds");
  }

  private static void restartClears() {
    Recording recording = new Recording("ekf");
    recording.add(estimate(500, 5000000, 3));
    recording.add(mark("ekf", 5000000));
    for (int i = 0; i < 19; ++i) {
      recording.add(estimate(i, 5000 * i, 3));
    }
    Snapshot s = recording.snapshot(kWidth);
    expect(s.counters.repeated == 19 && s.counters.restarts == 0 && s.marks.size() == 1,
        "some late messages are no restart");
    recording.add(estimate(19, 95000, 3));
    s = recording.snapshot(kWidth);
    expect(s.marks.isEmpty(), "a restart clears the marks");
    expect(points(s.estimate[0]) == 1, "a restart clears the curves");
    expect(s.t0 < 0.1 && s.counters.restarts == 1, "a restart begins the time axis anew");
  }

  private static void changedJointsClear() {
    Recording recording = new Recording("ekf");
    recording.add(estimate(0, 0, 3));
    for (int i = 1; i <= 20; ++i) {
      recording.add(estimate(i, 5000 * i, 7));
    }
    Snapshot s = recording.snapshot(kWidth);
    expect(s.n == 7 && points(s.estimate[0]) == 1, "another n begins anew");
  }

  private static void jumpOfSeqIsCounted() {
    Recording recording = new Recording("ekf");
    recording.add(estimate(0, 0, 3));
    recording.add(estimate(4, 20000, 3));
    recording.add(estimate(5, 25000, 3));
    expect(recording.snapshot(kWidth).counters.lost == 3, "a jump of seq by 4 is a loss of 3");
    recording.add(estimate(1L << 52, 30000, 3));
    recording.add(estimate(Long.MAX_VALUE, 35000, 3));
    Counters c = recording.snapshot(kWidth).counters;
    expect(c.lost == 3 && c.rejected == 1, "a forged seq is no loss");
  }

  private static void wrongJointsAreCountedAndIgnored() {
    Recording recording = new Recording("ekf");
    recording.add(estimate(0, 0, 3));
    for (int n : new int[] {0, 9, -1}) {
      recording.add(estimate(1, 5000, n));
    }
    Snapshot s = recording.snapshot(kWidth);
    expect(s.counters.rejected == 3 && s.counters.used == 1, "n of 0, 9 and -1 are counted");
    expect(s.n == 3 && s.counters.restarts == 0, "n of 0, 9 and -1 are ignored");
  }

  private static void malformedMessagesAreCountedAndIgnored() throws IOException {
    LCM bus = new LCM("memq://");
    Recording recording = new Recording("ekf");
    Receiver receiver = new Receiver(bus, kChannel, recording);
    byte[] good = bytes(estimate(0, 0, 3));
    byte[] forged = bytes(mark("ekf", 0));
    Arrays.fill(forged, 8 + 8 + 8 + 4 + 1 + 8 + 1 + 1 + 8, forged.length, (byte) 0x7f);  // lengths of strings
    receive(receiver, kChannel, good);
    receive(receiver, kChannel, Arrays.copyOf(good, good.length - 1));
    receive(receiver, kChannel, Arrays.copyOf(good, good.length + 1));
    receive(receiver, kChannel, bytes(mark("ekf", 0)));
    receive(receiver, kChannel, new byte[0]);
    receive(receiver, Receiver.kDetections, forged);
    Counters c = recording.snapshot(kWidth).counters;
    expect(c.used == 1 && c.rejected == 5, "what is no message is counted and ignored");
    receiver.close();
    bus.close();
  }

  private static void marksOfOtherEstimatorsAreLeftOut() {
    Recording ekf = new Recording(Receiver.estimator(kChannel));
    Recording all = new Recording(Receiver.estimator("ARM"));
    for (Recording r : new Recording[] {ekf, all}) {
      r.add(mark("ekf", 1000000));
      r.add(mark("ekf", 1000000));  // the same one
      r.add(mark("ndob", 1200000));
    }
    expect(ekf.snapshot(kWidth).marks.size() == 1, "another estimator's marks are left out");
    expect(all.snapshot(kWidth).marks.size() == 2, "a channel of another name shows all marks");
    expect(ekf.snapshot(kWidth).contact.max() == 1, "a true collision is shaded");
  }

  private static void aClosedWindowHearsNothing() throws IOException {
    LCM bus = new LCM("memq://");
    Receiver receiver = new Receiver(bus, kChannel, new Recording("ekf"));
    expect(bus.getNumSubscriptions() == 3, "a window subscribes to its channel, the detections and the summaries");
    receiver.close();
    expect(bus.getNumSubscriptions() == 0, "a closed window leaves no subscription");
    bus.close();
  }

  private static void everyMessageIsAccountedFor() {
    for (int gap : new int[] {1, 64, 65, 20000}) {
      Recording recording = new Recording("ekf");
      for (int k = 0; k < 200; ++k) {
        int seq = k < 100 ? k : k + gap;
        recording.add(estimate(seq, 5000L * seq, 3));
        if (k % 50 == 10) {
          recording.add(estimate(seq, 5000L * seq, 3));
        }
      }
      recording.add(estimate(100, 500000, 3));  // one of those that were lost
      summary_t s = new summary_t();
      s.entry = "wallmobot3/step/ekf+threshold";
      s.published = 2 * (200 + gap + 7);
      recording.end(s);
      Counters c = recording.snapshot(kWidth).counters;
      expect(c.used == 200 && c.repeated == 4 && c.late == 1 && c.rejected == 0 && c.lost == gap + 6,
          "all but the copies of " + s.published / 2 + " messages are accounted for, and those at the end");
    }
  }

  private static void ofTwoSendersTheFirstIsShown() {
    Senders senders = new Senders();
    InetSocketAddress one = new InetSocketAddress("127.0.0.1", 4000);
    InetSocketAddress two = new InetSocketAddress("127.0.0.1", 4001);
    long ms = 1_000_000L;
    expect(senders.take("A", one, 1, ms) && !senders.take("A", two, 1, 2 * ms), "the second sender is not shown");
    expect(senders.trouble("A").isEmpty(), "it may be a restart");
    expect(senders.take("A", one, 2, 3 * ms) && senders.trouble("A").contains("4001"), "both speak, and are named");
    expect(senders.take("B", one, 1, ms) && senders.take("B", two, 1, 600 * ms) && senders.trouble("B").isEmpty(),
        "a sender that has started anew is shown");
    for (int k = 1; k <= 600; ++k) {
      senders.take("C", one, 1, k * ms);
    }
    expect(senders.take("C", two, 1, 601 * ms), "who only repeats himself does not keep a channel");
  }

  private static void nonFiniteTorquesAreLeftOut() {
    Recording recording = new Recording("ekf");
    recording.add(estimate(0, 0, 1));
    estimate_t m = estimate(1, 5000, 1);
    m.tau_ext_hat[0] = Double.NaN;
    m.tau_ext_hat_max[0] = Double.POSITIVE_INFINITY;
    m.status = estimate_t.kDiverged;
    recording.add(m);
    Snapshot s = recording.snapshot(kWidth);
    expect(points(s.estimate[0]) == 1 && s.estimate[0].max() == 0, "what is not finite is not drawn");
    expect(s.counters.failed == 1, "a diverged estimator is counted");
  }

  private static estimate_t estimate(long seq, long utime, int n) {
    estimate_t m = new estimate_t();
    m.seq = seq;
    m.utime = utime;
    m.n = n;
    m.reference = estimate_t.kTruth;
    return m;
  }

  private static detection_t mark(String estimator, long utime) {
    detection_t d = new detection_t();
    d.utime = utime;
    d.mark = 1;
    d.mark_utime = utime;
    d.contact = detection_t.kCollision;
    d.contact_true = 1;
    d.estimator = estimator;
    d.detector = "threshold";
    return d;
  }

  private static long points(Columns c) {
    return Arrays.stream(c.last).filter(Double::isFinite).count();
  }

  private static byte[] bytes(LCMEncodable message) throws IOException {
    LCMDataOutputStream out = new LCMDataOutputStream();
    message.encode(out);
    return Arrays.copyOf(out.getBuffer(), out.size());
  }

  private static void receive(Receiver receiver, String channel, byte[] data) {
    receiver.messageReceived(null, channel, new LCMDataInputStream(data));
  }

  private static void expect(boolean holds, String claim) {
    if (!holds) {
      System.err.println("FAILED: " + claim);
      ++failures;
    }
  }
}
