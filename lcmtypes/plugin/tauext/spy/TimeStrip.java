// SPDX-License-Identifier: Apache-2.0
package tauext.spy;

import java.awt.Graphics2D;

/** Below the charts: the axis of message time [s], counted from a round second if the clock is a calendar's. */
final class TimeStrip extends Strip {
  TimeStrip() {
    super(34);
  }

  @Override
  void paint(Graphics2D g) {
    g.setColor(kText);
    Scale times = times();
    for (int i = 0; i < times.ticks(); ++i) {
      centre(g, times.label(times.tick(i)), x(times.tick(i) + snapshot.base), 13);
    }
    String offset = snapshot.base == 0 ? "" : String.format(" - %.0f s", snapshot.base);
    centre(g, "t" + offset + " [s], the time of the messages", kLeft + plotWidth() / 2, 29);
  }

  private void centre(Graphics2D g, String label, int x, int y) {
    int width = g.getFontMetrics().stringWidth(label);
    g.drawString(label, Math.min(x - width / 2, getWidth() - width - 2), y);
  }
}
