// SPDX-License-Identifier: Apache-2.0
package tauext.spy;

import java.util.Locale;

/** From values to pixels, linearly, with ticks at 1, 2 or 5 times a power of ten. */
final class Scale {
  private static final double kFloor = 0.02;  // [N m] so that rounding noise is not blown up

  final double from;
  final double to;
  final double step;
  private final int pixels;

  Scale(double from, double to, double step, int pixels) {
    this.from = from;
    this.to = to;
    this.step = step;
    this.pixels = pixels;
  }

  /** A scale that holds 0, lo and hi [N m] (NaN: nothing) and begins and ends at a tick. */
  static Scale around(double lo, double hi, int pixels) {
    double least = Double.isNaN(lo) ? 0 : Math.min(0, lo);
    double most = Double.isNaN(hi) ? 0 : Math.max(0, hi);
    if (most - least < kFloor) {
      least = -kFloor;
      most = kFloor;
    }
    double margin = 0.03 * (most - least);
    double step = nice((most - least) / Math.max(1, Math.min(6, pixels / 24)));
    return new Scale(step * Math.floor((least - margin) / step),
        step * Math.ceil((most + margin) / step), step, pixels);
  }

  int at(double value) {
    return (int) Math.round((value - from) / (to - from) * pixels);
  }

  int ticks() {
    return (int) Math.floor((to - from) / step + 1e-6) + 1;
  }

  double tick(int i) {
    return from + i * step;
  }

  String label(double value) {
    if (Math.max(Math.abs(from), Math.abs(to)) >= 1e6) {
      return String.format(Locale.ROOT, "%.1e", value);
    }
    int digits = Math.max(0, (int) -Math.floor(Math.log10(step) + 1e-9));
    double zero = Math.abs(value) < 1e-6 * step ? 0 : value;  // no -0
    return String.format(Locale.ROOT, "%." + digits + "f", zero);
  }

  /** The next larger 1, 2 or 5 times a power of ten. */
  private static double nice(double step) {
    double power = Math.pow(10, Math.floor(Math.log10(step)));
    for (double factor : new double[] {1, 2, 5}) {
      if (step <= factor * power * (1 + 1e-9)) {
        return factor * power;
      }
    }
    return 10 * power;
  }
}
