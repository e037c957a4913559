// SPDX-License-Identifier: Apache-2.0
package tauext.spy;

import java.net.InetSocketAddress;
import java.util.HashMap;
import java.util.Map;

/** Whose a channel is: its first sender's, until that one is silent. As lcmtypes/receive/senders.h. */
final class Senders {
  private static final long kSilence_ns = 500_000_000L;
  private static final int kMost = 1000;  // channels, whose names come from outside

  private static final class Channel {
    InetSocketAddress current;
    InetSocketAddress before;
    InetSocketAddress other;
    long heard_ns;
    boolean other_spoke;
    boolean crowded;
    int content;  // of its last message
  }

  private final Map<String, Channel> channels = new HashMap<>();

  /** Whether to use a message with this hash of its content; false for a second sender's, and for channels beyond the thousandth. */
  synchronized boolean take(String name, InetSocketAddress sender, int content, long now_ns) {
    Channel c = channels.get(name);
    if (c == null) {
      if (channels.size() >= kMost) {
        return false;
      }
      c = new Channel();
      c.current = sender;
      channels.put(name, c);
    }
    if (sender.equals(c.current)) {
      c.crowded |= c.other_spoke;
      c.other_spoke = false;
      if (content != c.content || c.heard_ns == 0) {  // whoever only repeats himself is silent
        c.heard_ns = now_ns;
      }
      c.content = content;
      return true;
    }
    c.other = sender;
    if (now_ns - c.heard_ns < kSilence_ns) {
      c.other_spoke = true;
      return false;
    }
    c.crowded |= sender.equals(c.before);
    c.before = c.current;
    c.other = c.before;
    c.current = sender;
    c.other_spoke = false;
    c.heard_ns = now_ns;
    c.content = content;
    return true;
  }

  /** Who both send on a channel, in words; "" if there is one sender alone. */
  synchronized String trouble(String name) {
    Channel c = channels.get(name);
    return c == null || !c.crowded ? "" : "two senders: " + name(c.current) + " is shown, and not " + name(c.other);
  }

  private static String name(InetSocketAddress sender) {
    return sender.getAddress().getHostAddress() + ":" + sender.getPort();
  }
}
