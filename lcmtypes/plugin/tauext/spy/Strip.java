// SPDX-License-Identifier: Apache-2.0
package tauext.spy;

import java.awt.Color;
import java.awt.Dimension;
import java.awt.Font;
import java.awt.Graphics;
import java.awt.Graphics2D;
import java.awt.RenderingHints;
import javax.swing.JPanel;

/** A strip of the window: what all of them share, so that their times and colours agree. */
abstract class Strip extends JPanel {
  static final int kLeft = 72;  // [pixels] for the labels of the y axis
  static final int kRight = 16;
  static final Color kTruth = new Color(0xf2a33a);
  static final Color kEstimate = new Color(0x1b4f9c);
  static final Color kExtremes = new Color(0x7fa9e0);
  static final Color kMark = new Color(0xc62828);
  static final Color kContact = new Color(0xece6f5);
  static final Color kGrid = new Color(0xe3e3e3);
  static final Color kText = new Color(0x303030);
  private static final Font kFont = new Font(Font.SANS_SERIF, Font.PLAIN, 12);

  protected transient Snapshot snapshot;

  Strip(int height) {
    setBackground(Color.WHITE);
    setFont(kFont);
    setPreferredSize(new Dimension(400, height));
  }

  final void show(Snapshot s) {
    snapshot = s;
    repaint();
  }

  /** [pixels] between the edges of the plot. */
  final int plotWidth() {
    return Math.max(1, getWidth() - kLeft - kRight);
  }

  /** The pixel of a time [s]. */
  final int x(double t) {
    double span = snapshot.t1 - snapshot.t0;
    return kLeft + (int) Math.min((t - snapshot.t0) / span * plotWidth(), plotWidth() - 1.0);
  }

  /** [s] between the lines of the grid; the scale of times. */
  final Scale times() {
    double first = Math.ceil((snapshot.t0 - snapshot.base) - 1e-9);
    return new Scale(first, snapshot.t1 - snapshot.base, 1, 1);
  }

  @Override
  protected final void paintComponent(Graphics graphics) {
    super.paintComponent(graphics);
    Graphics2D g = (Graphics2D) graphics.create();
    g.setRenderingHint(
        RenderingHints.KEY_TEXT_ANTIALIASING, RenderingHints.VALUE_TEXT_ANTIALIAS_ON);
    if (snapshot != null) {
      paint(g);
    }
    g.dispose();
  }

  abstract void paint(Graphics2D g);
}
