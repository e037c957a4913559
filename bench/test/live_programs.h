// SPDX-License-Identifier: Apache-2.0
// tauext-live in a script, and in a network of its own.
#pragma once

#include <cstdint>
#include <cstdlib>
#include <regex>
#include <string>

#include "bench/test/programs.h"
#include "lcmtypes/log.h"

namespace tauext::test {

inline constexpr const char* kRun =
    "tauext-live --robot wallmobot3 --scenario collision --estimator ekf,mo2,ndob ";

class LivePrograms : public Programs {
 protected:
  // a script in a network of its own, with tauext's programs in the path
  Outcome in_network(const std::string& script, bool route = true) const {
    const std::string up =
        route ? "ip link set lo up multicast on\nip route add 224.0.0.0/4 dev lo\n" : "";
    return run_script(up + script, "unshare -rn ");
  }
  // `says FILE TEXT` waits until the text is in the file, which no script before has left
  Outcome run_script(const std::string& script, const std::string& inside = "") const {
    write("script",
          "export PATH=" + kBin +
              ":$PATH\n"
              "rm -f heard out err sent\n"
              "says() { for i in $(seq 300); do grep -q \"$2\" \"$1\" 2>/dev/null && return; "
              "sleep 0.1; done; }\n" +
              script);
    return run_system(inside + "timeout 90 bash script");
  }

  // tauext-live in the background, listening
  static std::string listening(const std::string& flags) {
    return "tauext-live " + flags + " > heard 2>&1 & live=$!\nsays heard listening\n";
  }
  // and its end, with what it said and its exit code
  static constexpr const char* kSumUp =
      "sleep 0.5; kill -INT $live; wait $live; code=$?; cat heard; exit $code";

  bool forbidden() const { return std::system("unshare -rn true 2>/dev/null") != 0; }

  // the number before a word
  static std::int64_t number(const Outcome& o, const std::string& before) {
    std::smatch m;
    const std::regex pattern("([0-9]+) " + before);
    return std::regex_search(o.text, m, pattern) ? std::stoll(m[1]) : -1;
  }

  void put_log(const std::string& name, LogBuffer& log) const {
    write(name, std::string(log.bytes()));
  }
};

#define SKIP_WITHOUT_NAMESPACE()                                          \
  if (forbidden())                                                        \
  GTEST_SKIP() << "no network namespace of our own here: unshare -rn is " \
                  "forbidden"

}  // namespace tauext::test
