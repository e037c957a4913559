// SPDX-License-Identifier: Apache-2.0
package tauext.spy;

import java.awt.BorderLayout;
import java.awt.Color;
import java.awt.GridLayout;
import java.util.ArrayList;
import java.util.List;
import javax.swing.Box;
import javax.swing.JCheckBox;
import javax.swing.JPanel;
import javax.swing.Timer;
import lcm.lcm.LCM;

/** All joints of one channel, redrawn twenty times a second while messages come. */
final class EstimateView extends JPanel {
  private static final int kPeriod_ms = 50;

  private final transient Recording recording;
  private final transient Receiver receiver;
  private final Timer timer = new Timer(kPeriod_ms, e -> refresh());
  private final Legend legend = new Legend();
  private final MarkStrip marks = new MarkStrip();
  private final JPanel charts = new JPanel();
  private final TimeStrip time = new TimeStrip();
  private final StatusLine status;
  private final JCheckBox hold = new JCheckBox("hold the picture");
  private final List<Strip> strips = new ArrayList<>();
  private transient Snapshot drawn = new Snapshot();
  private long version = -1;
  private int width;

  EstimateView(LCM bus, String channel) {
    super(new BorderLayout());
    status = new StatusLine(channel);
    recording = new Recording(Receiver.estimator(channel));
    receiver = new Receiver(bus, channel, recording);
    add(stack(row(legend, hold), marks), BorderLayout.NORTH);
    add(charts, BorderLayout.CENTER);
    add(stack(time, row(status, null)), BorderLayout.SOUTH);
    rebuild(0);
    timer.start();
  }

  /** Ends the subscription; to be called when the window is closed. */
  void close() {
    timer.stop();
    receiver.close();
  }

  private void refresh() {
    Snapshot s = recording.snapshot(legend.getWidth() > 0 ? time.plotWidth() : 1);
    status.show(s);
    if (hold.isSelected() || recording.version() == version && width == getWidth()) {
      return;
    }
    version = recording.version();
    width = getWidth();
    if (s.n != drawn.n) {
      rebuild(s.n);
    }
    drawn = s;
    strips.forEach(strip -> strip.show(s));
  }

  private void rebuild(int n) {
    strips.clear();
    strips.addAll(List.of(legend, marks, time));
    charts.removeAll();
    charts.setLayout(new GridLayout(Math.max(1, n), 1));
    charts.setBackground(Color.WHITE);
    for (int i = 0; i < n; ++i) {
      ChartPanel chart = new ChartPanel(i);
      charts.add(chart);
      strips.add(chart);
    }
    charts.revalidate();
  }

  private static JPanel stack(JPanel upper, JPanel lower) {
    JPanel panel = new JPanel(new BorderLayout());
    panel.add(upper, BorderLayout.NORTH);
    panel.add(lower, BorderLayout.CENTER);
    return panel;
  }

  private static JPanel row(java.awt.Component left, java.awt.Component right) {
    JPanel panel = new JPanel(new BorderLayout());
    panel.setBackground(Color.WHITE);
    panel.add(left, BorderLayout.CENTER);
    panel.add(right == null ? Box.createHorizontalGlue() : right, BorderLayout.EAST);
    return panel;
  }
}
