// SPDX-License-Identifier: Apache-2.0
package tauext.spy;

/**
 * A curve over the last ten seconds of message time. What falls into the same 2 ms becomes one point that
 * keeps its minimum and maximum, so no rate of messages needs more room and no pulse is lost. The unit is the
 * caller's; values that no chart could show (infinite, NaN, above 1e12) are left out.
 */
final class Series {
  static final long kWindow_us = 10000000;
  static final long kPoint_us = 2000;
  private static final int kPoints = (int) (kWindow_us / kPoint_us) + 2;

  private final long[] utime = new long[kPoints];  // [us] of the last message in a point
  private final double[] first = new double[kPoints];
  private final double[] last = new double[kPoints];
  private final double[] lo = new double[kPoints];
  private final double[] hi = new double[kPoints];
  private int begin;
  private int size;

  /** Appends a message: its last value and the extremes since the one before. Times never go back. */
  void add(long t_us, double value, double min, double max) {
    if (!drawable(value) || !drawable(min) || !drawable(max)) {
      return;
    }
    double least = Math.min(value, Math.min(min, max));
    double most = Math.max(value, Math.max(min, max));
    int i = index(size - 1);
    if (size > 0 && Math.floorDiv(utime[i], kPoint_us) == Math.floorDiv(t_us, kPoint_us)) {
      lo[i] = Math.min(lo[i], least);
      hi[i] = Math.max(hi[i], most);
    } else {
      i = append();
      first[i] = value;
      lo[i] = least;
      hi[i] = most;
    }
    last[i] = value;
    utime[i] = t_us;
  }

  static boolean drawable(double value) {
    return Math.abs(value) <= 1e12;  // false for NaN
  }

  int size() {
    return size;
  }

  void clear() {
    size = 0;
  }

  /** [us] time of point i, 0 being the oldest. */
  long utime(int i) {
    return utime[index(i)];
  }

  double first(int i) {
    return first[index(i)];
  }

  double last(int i) {
    return last[index(i)];
  }

  double lo(int i) {
    return lo[index(i)];
  }

  double hi(int i) {
    return hi[index(i)];
  }

  private int append() {
    if (size == kPoints) {
      begin = index(1);
    } else {
      ++size;
    }
    return index(size - 1);
  }

  private int index(int i) {
    return Math.floorMod(begin + i, kPoints);
  }
}
