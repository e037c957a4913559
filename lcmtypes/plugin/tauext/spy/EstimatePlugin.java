// SPDX-License-Identifier: Apache-2.0
package tauext.spy;

import java.awt.event.ActionEvent;
import java.awt.event.WindowAdapter;
import java.awt.event.WindowEvent;
import java.io.IOException;
import javax.swing.AbstractAction;
import javax.swing.Action;
import javax.swing.JDesktopPane;
import javax.swing.JFrame;
import javax.swing.JOptionPane;
import javax.swing.SwingUtilities;
import lcm.spy.ChannelData;
import lcm.spy.SpyPlugin;
import tauext.estimate_t;

/** What lcm-spy opens for a channel of tauext.estimate_t: a window with truth and estimate, joint by joint. */
public final class EstimatePlugin implements SpyPlugin {
  @Override
  public boolean canHandle(long fingerprint) {
    return fingerprint == estimate_t.LCM_FINGERPRINT;
  }

  /** lcm-spy asks with (null, null) for the name alone. */
  @Override
  public Action getAction(JDesktopPane pane, ChannelData channel) {
    return new AbstractAction("Torques of all joints...") {
      @Override
      public void actionPerformed(ActionEvent event) {
        try {
          open(pane, channel.name);
        } catch (IOException | RuntimeException e) {
          JOptionPane.showMessageDialog(pane, "Cannot subscribe to " + channel.name + ": " + e);
        }
      }
    };
  }

  /** Takes over the window that lcm-spy has made around the pane. */
  private static void open(JDesktopPane pane, String channel) throws IOException {
    JFrame frame = pane == null ? null : (JFrame) SwingUtilities.getWindowAncestor(pane);
    if (frame == null) {
      frame = new JFrame(channel);
    }
    EstimateView view = new EstimateView(Main.bus(), channel);
    frame.setDefaultCloseOperation(JFrame.DISPOSE_ON_CLOSE);
    frame.addWindowListener(
        new WindowAdapter() {
          @Override
          public void windowClosed(WindowEvent e) {
            view.close();
          }
        });
    frame.setContentPane(view);
    frame.setSize(1100, 760);
    frame.setVisible(true);
  }
}
