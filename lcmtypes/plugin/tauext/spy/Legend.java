// SPDX-License-Identifier: Apache-2.0
package tauext.spy;

import java.awt.Color;
import java.awt.Graphics2D;
import tauext.estimate_t;

/** The heading: quantity, unit and sign, and what each colour means. */
final class Legend extends Strip {
  private static final String kSign =
      "External torque tau_ext [N m], in B qdd + C qd + F + g + tau_ext = tau: "
      + "a force f on the robot gives -J^T f.";

  Legend() {
    super(44);
  }

  @Override
  void paint(Graphics2D g) {
    g.setColor(kText);
    g.drawString(kSign, 8, 17);
    int x = 8;
    x = entry(g, x, kEstimate, 2, "estimate");
    x = entry(g, x, kExtremes, 10, "its extremes since the message before");
    if (snapshot.reference != estimate_t.kNone) {
      x = entry(g, x, kTruth, 3,
          snapshot.reference == estimate_t.kTruth ? "truth" : "sender's own estimate");
    }
    x = entry(g, x, kMark, 10, "a detector's mark");
    if (snapshot.contact.max() > 0) {
      entry(g, x, kContact, 12, "collision acts (truth)");
    }
  }

  private static int entry(Graphics2D g, int x, Color colour, int thick, String text) {
    boolean upright = colour.equals(kMark);
    g.setColor(colour);
    g.fillRect(x + (upright ? 9 : 0), 34 - thick / 2, upright ? 2 : 20, thick);
    g.setColor(kText);
    g.drawString(text, x + 26, 38);
    return x + 46 + g.getFontMetrics().stringWidth(text);
  }
}
