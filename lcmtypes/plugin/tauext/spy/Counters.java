// SPDX-License-Identifier: Apache-2.0
package tauext.spy;

/** What became of the messages since the window was opened. All in [1]. */
final class Counters implements Cloneable {
  long used;       // that are drawn
  long late;       // that were overtaken by a newer one; they are ignored
  long repeated;   // that had come before
  long rejected;   // that are no estimate or detection, have a wrong n, or are another sender's
  long lost;       // that never came: jumps of seq
  long restarts;   // of the stream: utime or seq went back for long, or n changed
  long failed;     // estimates whose status says that a sample went wrong

  byte status;          // of the last message
  byte failure;         // the last status that was a failure
  double failure_t;     // [s] when it was
  double step_us;       // [us] of the last message; 0 if it was not live

  @Override
  public Counters clone() {
    try {
      return (Counters) super.clone();
    } catch (CloneNotSupportedException e) {
      throw new AssertionError(e);
    }
  }
}
