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
    "ok", "started", "bad measurement", "singular inertia", "diverged",
    "bad time", "beyond a limit", "jump", "frozen", "unlikely"
  };
  private static final double kSilent_s = 1.5;

  private final String channel;
  private long ticked_ns = System.nanoTime();
  private long arrived_ns = ticked_ns;
  private long counted;
  private long out_of_turn;
  private long dropped;    // by the kernel since the window was opened, whatever their channel
  private final long dropped_before = Main.group() == null ? 0 : Main.group().dropped();
  private double rate;     // [1/s] messages, over the last second of the viewer's clock
  private String trouble = "";

  StatusLine(String channel) {
    this.channel = channel;
    setBorder(BorderFactory.createEmptyBorder(4, 8, 4, 8));
    setFont(new Font(Font.SANS_SERIF, Font.PLAIN, 12));
  }

  void show(Snapshot s) {
    Counters c = s.counters;
    double silent = tick(c);
    boolean bad = silent > kSilent_s || c.failed > 0 || c.rejected > 0 || !trouble.isEmpty();
    setForeground(bad ? Strip.kMark : Color.BLACK);
    setText(text(s, silent));
  }

  private String text(Snapshot s, double silent) {
    Counters c = s.counters;
    String text = silent > kSilent_s ? format("no message for %.0f s", silent) : format("%.0f messages/s", rate);
    long drops = Math.min(dropped, c.lost);
    text += format("  |  %d sent = %d used + %d late + %d repeated + %d rejected + %d lost + %d dropped by the kernel",
        c.used + c.late + c.repeated + c.rejected + c.lost, c.used, c.late, c.repeated, c.rejected, c.lost - drops, drops);
    text += c.restarts > 0 ? format(", %d restarts", c.restarts) : "";
    text += trouble.isEmpty() ? "" : "  |  " + trouble;
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
  private double tick(Counters c) {
    long now = System.nanoTime();
    double elapsed = 1e-9 * (now - ticked_ns);
    if (elapsed >= 1) {
      rate = (c.used - counted) / elapsed;
      arrived_ns = c.used > counted ? now : arrived_ns;
      counted = c.used;
      ticked_ns = now;
      look(c);
    }
    return 1e-9 * (now - arrived_ns);
  }

  /** Whether two senders share the channel, and what the kernel has dropped. */
  private void look(Counters c) {
    Group group = Main.group();
    long out = c.late + c.repeated + c.rejected;
    if (group != null) {
      dropped = group.dropped() - dropped_before;
      trouble = group.trouble(channel);
    } else if (out - out_of_turn >= Sequence.kPatience) {
      trouble = "messages come out of turn: two senders?";
    }
    out_of_turn = out;
  }

  private static String name(byte status) {
    return status >= 0 && status < kStatus.length ? kStatus[status] : "status " + status;
  }

  private static String format(String pattern, Object... values) {
    return String.format(Locale.ROOT, pattern, values);
  }
}
