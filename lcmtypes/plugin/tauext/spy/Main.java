// SPDX-License-Identifier: Apache-2.0
package tauext.spy;

import java.awt.AWTError;
import java.io.IOException;
import java.lang.reflect.Field;
import lcm.lcm.LCM;
import lcm.spy.Spy;

/**
 * Starts lcm-spy, and lets the plug-in hear what lcm-spy hears: lcm-spy hands its plug-ins the last message
 * only, and keeps its bus to itself. Under an lcm-spy started in another way, the plug-in listens to
 * LCM_DEFAULT_URL.
 */
public final class Main {
  private static LCM bus;
  private static Group group;  // null: on tcpq, or a log

  private Main() {}

  /** The bus that lcm-spy listens to. */
  static synchronized LCM bus() throws IOException {
    if (bus == null) {
      bus = new LCM();
    }
    return bus;
  }

  /** What receives multicast; null if nothing of ours does. */
  static synchronized Group group() {
    return group;
  }

  private static synchronized void share(Spy spy, String url) throws IOException, ReflectiveOperationException {
    Field field = Spy.class.getDeclaredField("lcm");
    field.setAccessible(true);
    bus = (LCM) field.get(spy);
    if (url.startsWith("udpm://")) {
      group = new Group(bus, url);
      group.start();
    }
  }

  /** Argument: the URL to listen to. */
  public static void main(String[] args) {
    try {
      share(new Spy(args[0].startsWith("udpm://") ? "memq://" : args[0]), args[0]);
    } catch (IOException | ReflectiveOperationException | RuntimeException | AWTError e) {
      System.err.println("tauext-spy: " + e);
      System.exit(1);  // lcm-spy's window is open already and would stay
    }
  }
}
