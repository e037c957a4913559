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

  private Main() {}

  /** The bus that lcm-spy listens to. */
  static synchronized LCM bus() throws IOException {
    if (bus == null) {
      bus = new LCM();
    }
    return bus;
  }

  private static synchronized void share(Spy spy) throws ReflectiveOperationException {
    Field field = Spy.class.getDeclaredField("lcm");
    field.setAccessible(true);
    bus = (LCM) field.get(spy);
  }

  /** Argument: the URL to listen to; without one, LCM_DEFAULT_URL or LCM's own default. */
  public static void main(String[] args) {
    try {
      share(new Spy(args.length > 0 ? args[0] : null));
    } catch (IOException | ReflectiveOperationException | RuntimeException | AWTError e) {
      System.err.println("tauext-spy: " + e);
      System.exit(1);  // lcm-spy's window is open already and would stay
    }
  }
}
