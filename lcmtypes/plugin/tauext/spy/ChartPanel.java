// SPDX-License-Identifier: Apache-2.0
package tauext.spy;

import java.awt.Color;
import java.awt.Graphics2D;

/** The chart of one joint: estimate above truth [N m] over message time [s], and the marks. */
final class ChartPanel extends Strip {
  private static final int kTop = 6;
  private static final int kBottom = 6;
  private static final long kGap_us = 500000;  // without a message for so long, the line ends

  private final int joint;

  ChartPanel(int joint) {
    super(60);
    this.joint = joint;
  }

  @Override
  void paint(Graphics2D g) {
    if (joint >= snapshot.n) {
      return;
    }
    Columns truth = snapshot.truth[joint];
    Columns estimate = snapshot.estimate[joint];
    int height = Math.max(1, getHeight() - kTop - kBottom);
    Scale y = Scale.around(least(truth.min(), estimate.min()), -least(-truth.max(), -estimate.max()), height);
    shade(g, height);
    grid(g, y, height);
    curve(g, truth, y, height, 3, kTruth, kTruth);
    curve(g, estimate, y, height, 1, kEstimate, kExtremes);
    g.setColor(kMark);
    for (Mark m : snapshot.marks) {
      g.fillRect(x(m.t()), kTop, 2, height + 1);
    }
    g.setColor(kText);
    g.drawString("joint " + (joint + 1) + " [N m]", kLeft + 6, kTop + 14);
  }

  /** The smaller of two of which one may be NaN. */
  private static double least(double a, double b) {
    return Double.isNaN(a) || b < a ? b : a;
  }

  /** From the message before to each one that says that a collision acted. */
  private void shade(Graphics2D g, int height) {
    g.setColor(kContact);
    int begin = 0;
    for (int c = 0; c < snapshot.contact.width; ++c) {
      if (snapshot.contact.has(c)) {
        if (snapshot.contact.hi[c] > 0) {
          g.fillRect(kLeft + begin, kTop, c + 1 - begin, height);
        }
        begin = c + 1;
      }
    }
  }

  private void grid(Graphics2D g, Scale y, int height) {
    Scale times = times();
    for (int i = 0; i < times.ticks(); ++i) {
      g.setColor(kGrid);
      int x = x(times.tick(i) + snapshot.base);
      g.drawLine(x, kTop, x, kTop + height);
    }
    for (int i = 0; i < y.ticks(); ++i) {
      int row = kTop + height - y.at(y.tick(i));
      g.setColor(Math.abs(y.tick(i)) < 1e-6 * y.step ? Color.GRAY : kGrid);
      g.drawLine(kLeft, row, kLeft + plotWidth(), row);
      String label = y.label(y.tick(i));
      g.setColor(kText);
      g.drawString(label, kLeft - 6 - g.getFontMetrics().stringWidth(label), row + 4);
    }
  }

  /** The extremes as one bar per column of pixels, and a line through the values. */
  private void curve(
      Graphics2D g, Columns c, Scale y, int height, int thick, Color line, Color extremes) {
    int zero = kTop + height;
    int before = -1;
    int gap = (int) (kGap_us * c.width / Series.kWindow_us);
    g.setColor(extremes);
    for (int i = 0; i < c.width; ++i) {
      if (c.has(i)) {
        bar(g, kLeft + i, zero - y.at(c.lo[i]), zero - y.at(c.hi[i]), thick);
      }
    }
    g.setColor(line);
    for (int i = 0; i < c.width; ++i) {
      if (c.has(i)) {
        if (before >= 0 && i - before <= gap) {
          join(g, before, zero - y.at(c.last[before]), i, zero - y.at(c.first[i]), thick);
        }
        bar(g, kLeft + i, zero - y.at(c.first[i]), zero - y.at(c.last[i]), thick);
        before = i;
      }
    }
  }

  private static void bar(Graphics2D g, int x, int y0, int y1, int thick) {
    g.fillRect(x - thick / 2, Math.min(y0, y1) - thick / 2, thick, Math.abs(y1 - y0) + thick);
  }

  private static void join(Graphics2D g, int x0, int y0, int x1, int y1, int thick) {
    for (int k = -(thick / 2); k <= thick / 2; ++k) {
      g.drawLine(kLeft + x0, y0 + k, kLeft + x1, y1 + k);
    }
  }
}
