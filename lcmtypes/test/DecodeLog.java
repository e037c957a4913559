// SPDX-License-Identifier: Apache-2.0

import java.io.DataInput;
import java.io.EOFException;
import java.io.OutputStream;
import java.io.PrintStream;
import java.lang.reflect.Field;
import java.math.BigDecimal;
import java.math.MathContext;
import java.util.Locale;
import java.util.TreeMap;
import lcm.lcm.LCMDataInputStream;
import lcm.logging.Log;
import lcm.spy.LCMTypeDatabase;

/**
 * Decodes a log as lcm-spy would, without a screen. A line per channel: its name, type, number of messages,
 * first and last utime, and the sum over its messages of the sum of all their doubles, in order. Exits with 1
 * if a message is of no known type or cannot be decoded.
 */
public final class DecodeLog {
  private String type;
  private long count;
  private long first;
  private long last;
  private double sum;

  private DecodeLog() {}

  private void add(Object message) throws ReflectiveOperationException {
    long utime = message.getClass().getField("utime").getLong(message);
    first = count++ == 0 ? utime : first;
    last = utime;
    type = message.getClass().getName();
    double doubles = 0;
    for (Field field : message.getClass().getFields()) {
      Object value = field.get(message);
      for (double x : value instanceof double[] ? (double[]) value : new double[0]) {
        doubles += x;
      }
      doubles += value instanceof Double ? (Double) value : 0;
    }
    sum += doubles;
  }

  /** As C prints %.17g; Java's has fewer digits and trailing zeros. */
  private static String text(double x) {
    if (x == 0 || Double.isNaN(x) || Double.isInfinite(x)) {
      return x == 0 ? "0" : Double.isNaN(x) ? "nan" : x > 0 ? "inf" : "-inf";
    }
    BigDecimal b = new BigDecimal(x).round(new MathContext(17)).stripTrailingZeros();
    int exponent = b.precision() - b.scale() - 1;
    if (exponent >= -4 && exponent < 17) {
      return b.toPlainString();
    }
    return b.scaleByPowerOfTen(-exponent).toPlainString()
        + String.format(Locale.ROOT, "e%s%02d", exponent < 0 ? "-" : "+", Math.abs(exponent));
  }

  public static void main(String[] args) throws Exception {
    if (args.length != 1) {
      System.err.println("usage: DecodeLog LOG");
      System.exit(2);
    }
    PrintStream out = System.out;
    System.setOut(new PrintStream(OutputStream.nullOutputStream()));  // it lists what it cannot load
    LCMTypeDatabase types = new LCMTypeDatabase();
    System.setOut(out);
    TreeMap<String, DecodeLog> channels = new TreeMap<>();
    long unknown = 0;
    Log log = new Log(args[0], "r");
    try {
      while (true) {
        Log.Event event = log.readNext();
        LCMDataInputStream in = new LCMDataInputStream(event.data);
        Class<?> type = event.data.length < 8 ? null : types.getClassByFingerprint(in.readLong());
        in.reset();
        if (type == null) {
          ++unknown;
          continue;
        }
        channels.computeIfAbsent(event.channel, c -> new DecodeLog())
            .add(type.getConstructor(DataInput.class).newInstance(in));
      }
    } catch (EOFException e) {
      // the end of the log
    }
    channels.forEach((name, c) -> System.out.printf(
        "%s %s %d %d %d %s%n", name, c.type, c.count, c.first, c.last, text(c.sum)));
    if (unknown > 0) {
      System.err.println(unknown + " messages of no known type in " + args[0]);
      System.exit(1);
    }
  }
}
