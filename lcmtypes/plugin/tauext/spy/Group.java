// SPDX-License-Identifier: Apache-2.0
package tauext.spy;

import java.io.IOException;
import java.net.DatagramPacket;
import java.net.InetAddress;
import java.net.InetSocketAddress;
import java.net.MulticastSocket;
import java.net.NetworkInterface;
import java.nio.ByteBuffer;
import java.nio.charset.StandardCharsets;
import java.nio.file.Files;
import java.nio.file.Path;
import java.nio.file.Paths;
import java.util.Collections;
import java.util.HashSet;
import java.util.List;
import java.util.Set;
import java.util.stream.Collectors;
import java.util.stream.Stream;
import lcm.lcm.LCM;

/**
 * LCM's multicast, received for a bus by a socket of ours: one datagram of anybody ends LCM's own receiver.
 * It judges as lcmtypes/receive/group_socket.h does: short messages alone, and with ttl=0 this machine's alone.
 */
final class Group extends Thread {
  private static final int kShort = 0x4c433032;     // LC02
  private static final int kFragment = 0x4c433033;  // LC03
  private static final int kHead = 8;
  private static final int kLongestChannel = 63;
  private static final long kSecond_ns = 1_000_000_000L;

  private final LCM bus;
  private final MulticastSocket socket;
  private final boolean everybody;
  private final Senders senders = new Senders();
  private final String place;  // of the socket, as in /proc/net/udp
  private final Set<InetAddress> ours = new HashSet<>();
  private final boolean zeroIsOurs;  // 224.0.0.x alone may be sent to without an address
  private long addresses_ns;
  private final Set<String> told = new HashSet<>();  // kinds of refusals

  /** Where a URL udpm://GROUP:PORT?ttl=N says. */
  Group(LCM bus, String url) throws IOException {
    super("udpm");
    String[] parts = url.substring("udpm://".length()).split("\\?", 2);
    String[] where = parts[0].split(":", 2);
    InetAddress group = InetAddress.getByName(where[0].isEmpty() ? "239.255.76.67" : where[0]);
    int port = where.length > 1 && !where[1].isEmpty() ? Integer.parseInt(where[1]) : 7667;
    everybody = parts.length > 1 && Stream.of(parts[1].split("&")).anyMatch(o -> o.matches("ttl=0*[1-9][0-9]*"));
    this.bus = bus;
    socket = new MulticastSocket(null);
    socket.setReuseAddress(true);
    socket.setReceiveBufferSize(2 * 1024 * 1024);
    socket.bind(new InetSocketAddress(group, port));  // so nothing sent to an address arrives
    byte[] a = group.getAddress();
    zeroIsOurs = (a[0] & 0xff) != 224 || a[1] != 0 || a[2] != 0;
    place = String.format("%02X%02X%02X%02X:%04X", a[3], a[2], a[1], a[0], port);
    boolean joined = false;
    for (NetworkInterface i : Collections.list(NetworkInterface.getNetworkInterfaces())) {
      try {
        socket.joinGroup(new InetSocketAddress(group, port), i);
        joined = true;
      } catch (IOException e) {
        continue;  // one that knows no multicast
      }
    }
    if (!joined) {
      throw new IOException("no interface for multicast");
    }
    readAddresses();
    setDaemon(true);
  }

  @Override
  public void run() {
    DatagramPacket packet = new DatagramPacket(new byte[65536], 65536);
    while (true) {
      try {
        socket.receive(packet);
        take(packet);
      } catch (IOException | RuntimeException | OutOfMemoryError e) {
        refuse(String.valueOf(e));  // of a subscriber, whom a message has surprised
      }
    }
  }

  /** Who both send on a channel; "" if there is one sender alone. */
  String trouble(String channel) {
    return senders.trouble(channel);
  }

  /** Datagrams that came faster than they were taken, whatever their channel. */
  long dropped() {
    try {
      Set<String> sockets = new HashSet<>();
      try (Stream<Path> all = Files.list(Paths.get("/proc/self/fd"))) {
        for (Path p : all.collect(Collectors.toList())) {
          if (Files.isSymbolicLink(p)) {
            sockets.add(Files.readSymbolicLink(p).toString());
          }
        }
      }
      List<String> rows = Files.readAllLines(Paths.get("/proc/net/udp"));
      for (String row : rows) {
        String[] f = row.trim().split("\\s+");
        if (f.length > 12 && f[1].equals(place) && sockets.contains("socket:[" + f[9] + "]")) {
          return Long.parseLong(f[12]);
        }
      }
    } catch (IOException | RuntimeException e) {
      return 0;  // no such files here
    }
    return 0;
  }

  private void take(DatagramPacket packet) {
    if (!everybody && !isOurs(packet.getAddress())) {
      refuse("datagrams from " + packet.getAddress().getHostAddress() + ", outside this machine (ttl=1 takes them)");
      return;
    }
    ByteBuffer in = ByteBuffer.wrap(packet.getData(), 0, packet.getLength());
    int magic = packet.getLength() < kHead ? 0 : in.getInt();
    int end = kHead;
    while (end < in.limit() && in.get(end) != 0) {
      ++end;
    }
    if (magic != kShort || end == kHead || end >= in.limit() || end - kHead > kLongestChannel) {
      refuse(magic == kFragment ? "a part of a message beyond 64 kB" : "what is no message of LCM");
      return;
    }
    String channel = new String(in.array(), kHead, end - kHead, StandardCharsets.ISO_8859_1);
    int content = ByteBuffer.wrap(in.array(), end + 1, in.limit() - end - 1).hashCode();
    if (!senders.take(channel, (InetSocketAddress) packet.getSocketAddress(), content, System.nanoTime())) {
      refuse("a message of a second sender, or of more channels than can be shown");
      return;
    }
    bus.receiveMessage(channel, in.array(), end + 1, in.limit() - end - 1);
  }

  private boolean isOurs(InetAddress address) {
    if (address.isAnyLocalAddress()) {
      return zeroIsOurs;
    }
    if (System.nanoTime() - addresses_ns > kSecond_ns) {
      readAddresses();
    }
    return ours.contains(address);
  }

  private void readAddresses() {
    addresses_ns = System.nanoTime();
    ours.clear();
    try {
      for (NetworkInterface i : Collections.list(NetworkInterface.getNetworkInterfaces())) {
        ours.addAll(Collections.list(i.getInetAddresses()));
      }
    } catch (IOException e) {
      refuse("all until this machine's addresses can be read: " + e);
    }
  }

  /** Says each kind once. */
  private void refuse(String what) {
    if (told.size() < 100 && told.add(what)) {
      System.err.println("tauext-spy: refused " + what);
    }
  }
}
