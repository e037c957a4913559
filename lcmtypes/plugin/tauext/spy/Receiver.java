// SPDX-License-Identifier: Apache-2.0
package tauext.spy;

import java.io.IOException;
import java.util.regex.Pattern;
import lcm.lcm.LCM;
import lcm.lcm.LCMDataInputStream;
import lcm.lcm.LCMSubscriber;
import tauext.detection_t;
import tauext.estimate_t;
import tauext.summary_t;

/** Puts every message of a channel of estimates, and the detections, into a recording until it is closed. */
final class Receiver implements LCMSubscriber, AutoCloseable {
  static final String kEstimates = "TAUEXT_ESTIMATE_";
  static final String kDetections = "TAUEXT_DETECTION";
  private static final String kSummaries = "TAUEXT_SUMMARY";

  private final LCM bus;
  private final String channel;  // as an expression
  private final Recording recording;

  Receiver(LCM bus, String channel, Recording recording) {
    this.bus = bus;
    this.channel = Pattern.quote(channel);
    this.recording = recording;
    bus.subscribe(this.channel, this);
    bus.subscribe(kDetections, this);
    bus.subscribe(kSummaries, this);
  }

  /** Whose estimates a channel carries; "" if its name does not say. */
  static String estimator(String channel) {
    return channel.startsWith(kEstimates) ? channel.substring(kEstimates.length()) : "";
  }

  @Override
  public void messageReceived(LCM lcm, String channel, LCMDataInputStream in) {
    // a forged length of a string has the generated code ask for gigabytes
    try {
      if (channel.equals(kDetections)) {
        detection_t detection = new detection_t(in);
        check(in);
        recording.add(detection);
      } else if (channel.equals(kSummaries)) {
        recording.end(new summary_t(in));
      } else {
        estimate_t estimate = new estimate_t(in);
        check(in);
        recording.add(estimate);
      }
    } catch (IOException | RuntimeException | OutOfMemoryError e) {
      recording.reject();
    }
  }

  @Override
  public void close() {
    bus.unsubscribe(channel, this);  // by name: on tcpq a null is an exception
    bus.unsubscribe(kDetections, this);
    bus.unsubscribe(kSummaries, this);
  }

  private static void check(LCMDataInputStream in) throws IOException {
    if (in.available() != 0) {
      throw new IOException("longer than the type");
    }
  }
}
