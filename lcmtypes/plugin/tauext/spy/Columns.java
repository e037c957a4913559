// SPDX-License-Identifier: Apache-2.0
package tauext.spy;

import java.util.Arrays;

/**
 * What a chart draws of a series: for each column of pixels the first and last value and the extremes of the
 * points in it. A column without points holds NaN.
 */
final class Columns {
  final int width;
  final double[] first;
  final double[] last;
  final double[] lo;
  final double[] hi;

  /** The points of the window that ends at t1 [us], in so many columns. */
  Columns(Series series, long t1, int width) {
    this.width = width;
    first = empty();
    last = empty();
    lo = empty();
    hi = empty();
    for (int i = 0; i < series.size(); ++i) {
      long t = series.utime(i) - (t1 - Series.kWindow_us);
      if (t >= 0 && t <= Series.kWindow_us) {
        put((int) Math.min(t * width / Series.kWindow_us, width - 1), series, i);
      }
    }
  }

  boolean has(int column) {
    return !Double.isNaN(last[column]);
  }

  /** The smallest value of all columns; NaN without points. */
  double min() {
    return Arrays.stream(lo).filter(Double::isFinite).min().orElse(Double.NaN);
  }

  /** The largest value of all columns; NaN without points. */
  double max() {
    return Arrays.stream(hi).filter(Double::isFinite).max().orElse(Double.NaN);
  }

  private void put(int column, Series series, int i) {
    boolean more = has(column);
    first[column] = more ? first[column] : series.first(i);
    last[column] = series.last(i);
    lo[column] = more ? Math.min(lo[column], series.lo(i)) : series.lo(i);
    hi[column] = more ? Math.max(hi[column], series.hi(i)) : series.hi(i);
  }

  private double[] empty() {
    double[] values = new double[width];
    Arrays.fill(values, Double.NaN);
    return values;
  }
}
