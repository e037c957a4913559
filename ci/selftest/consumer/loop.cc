// SPDX-License-Identifier: Apache-2.0
// A control loop of one's own that streams its estimates, as lcmtypes/README.md shows it.
#include <lcmtypes/live_stream.h>

#include <cstdio>
#include <memory>

int main() {
  const auto lcm = std::make_shared<tauext::Transport>("memq://");
  tauext::LiveStream stream(lcm, {{"mine", ""}}, 200);
  tauext::LiveSample s;
  for (int k = 0; k < 1000; ++k) {  // a second of cycles of 1 ms
    s.reading.utime = 1000 * k;
    s.reading.t = 1e-3 * k;
    s.reading.n = 2;
    s.tau_ext_hat = {1, 2};
    stream.push(s);
  }
  const bool ended = stream.finish();
  std::printf("%s: %lld messages, %lld dropped\n", ended ? "ended" : "hangs",
              static_cast<long long>(stream.counts().published),
              static_cast<long long>(stream.counts().dropped));
}
