// SPDX-License-Identifier: Apache-2.0
package tauext.spy;

import java.util.Locale;
import tauext.detection_t;

/** A detector's mark: from here on the robot should react. */
final class Mark {
  private static final String[] kContacts = {"mark", "intentional", "collision", "clamping"};

  final long utime;  // [us]
  final int contact;
  final String detector;

  Mark(detection_t d) {
    utime = d.mark_utime;
    contact = d.contact >= 0 && d.contact < kContacts.length ? d.contact : 0;
    detector = d.detector.substring(0, Math.min(d.detector.length(), 40));
  }

  double t() {
    return 1e-6 * utime;
  }

  boolean same(Mark other) {
    return utime == other.utime && contact == other.contact && detector.equals(other.detector);
  }

  /** Such as "collision 5.023 s contact_classifier", the time counted from `base` [s]. */
  String label(double base) {
    return String.format(Locale.ROOT, "%s %.3f s %s", kContacts[contact], t() - base, detector);
  }
}
