// SPDX-License-Identifier: Apache-2.0
package tauext.spy;

import java.awt.Graphics2D;

/** Above the charts: what each mark says. Labels that would overlap go into a row of their own. */
final class MarkStrip extends Strip {
  private static final int kRows = 3;
  private static final int kRow = 15;  // [pixels]

  MarkStrip() {
    super(kRows * kRow + 3);
  }

  @Override
  void paint(Graphics2D g) {
    g.setColor(kMark);
    each((label, x, left, width, y) -> g.fillRect(x, y - 9, 2, getHeight()), g);
    each((label, x, left, width, y) -> {  // above the lines of others
      g.setColor(getBackground());
      g.fillRect(left - 1, y - kRow + 4, width + 2, kRow - 1);
      g.setColor(kMark);
      g.drawString(label, left, y);
    }, g);
  }

  private interface Draw {
    void label(String text, int x, int left, int width, int y);
  }

  /** Each mark that has room: where its line is, and where its label. */
  private void each(Draw draw, Graphics2D g) {
    int[] end = new int[kRows];
    for (Mark m : snapshot.marks) {
      String label = m.label(snapshot.base);
      int width = g.getFontMetrics().stringWidth(label);
      int left = Math.min(x(m.t()) + 5, getWidth() - width - 4);
      int row = free(end, left);
      if (row >= 0) {
        end[row] = left + width + 12;
        draw.label(label, x(m.t()), left, width, getHeight() - 4 - row * kRow);
      }
    }
  }

  /** The lowest row that is free from x on; -1 if none is. */
  private static int free(int[] end, int x) {
    for (int row = 0; row < end.length; ++row) {
      if (end[row] <= x) {
        return row;
      }
    }
    return -1;
  }
}
