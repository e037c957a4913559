// SPDX-License-Identifier: Apache-2.0
package tauext.spy;

import java.awt.Color;
import java.awt.Font;
import java.util.Locale;
import javax.swing.BorderFactory;
import javax.swing.JLabel;

/** What became of the messages, in a line; red while something is wrong. */
final class StatusLine extends JLabel {
  private static final String[] kStatus = {
    "ok", "started", "bad measurement", "singular inertia", "diverged"
  };
  private static final double kSilent_s = 1.5;

  private long ticked_ns = System.nanoTime();
  private long arrived_ns = ticked_ns;
  private long counted;
  private double rate;  // [1/s] messages, over the last second of the viewer's clock

  StatusLine() {
    setBorder(BorderFactory.createEmptyBorder(4, 8, 4, 8));
    setFont(new Font(Font.SANS_SERIF, Font.PLAIN, 12));
  }

  void show(Snapshot s) {
    Counters c = s.counters;
    double silent = tick(c.messages);
    setForeground(silent > kSilent_s || c.failed > 0 || c.malformed > 0 ? Strip.kMark : Color.BLACK);
    setText(text(s, silent));
  }

  private String text(Snapshot s, double silent) {
    Counters c = s.counters;
    String text = silent > kSilent_s ? format("no message for %.0f s", silent) : format("%.0f messages/s", rate);
    text += format("  |  %d messages, %d lost, %d late, %d malformed, %d restarts", c.messages,
        c.lost, c.late, c.malformed, c.restarts);
    text += "  |  estimator: " + name(c.status);
    if (c.failed > 0) {
      text += format(" (%d messages not; %s at %.3f s)", c.failed, name(c.failure), c.failure_t - s.base);
    }
    if (s.longest_us > 0) {
      text += format("  |  step %.1f us, longest of 10 s %.1f us", c.step_us, s.longest_us);
    }
    return text;
  }

  /** Updates the rate once a second; returns for how long [s] nothing has come. */
  private double tick(long messages) {
    long now = System.nanoTime();
    double elapsed = 1e-9 * (now - ticked_ns);
    if (elapsed >= 1) {
      rate = (messages - counted) / elapsed;
      arrived_ns = messages > counted ? now : arrived_ns;
      counted = messages;
      ticked_ns = now;
    }
    return 1e-9 * (now - arrived_ns);
  }

  private static String name(byte status) {
    return status >= 0 && status < kStatus.length ? kStatus[status] : "status " + status;
  }

  private static String format(String pattern, Object... values) {
    return String.format(Locale.ROOT, pattern, values);
  }
}
