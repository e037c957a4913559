// SPDX-License-Identifier: Apache-2.0
#include <bench/score/suite.h>

#include <cstdio>

int main() {
  tauext::Suite suite{tauext::SuiteOptions{}};
  const tauext::Entry entry{"wallmobot3", "free", "ndob", ""};
  std::printf("%s: rmse %.3f N m\n", entry.name().c_str(),
              *suite.score(entry).get(tauext::Metric::kRmse));
}
