// SPDX-License-Identifier: Apache-2.0
// Section 5.2, Table III: what can be said of it. Nothing is gated on its figures.
#include "bench/study/table3.h"

#include <gtest/gtest.h>

#include <cmath>

namespace tauext::test {
namespace {

// largest |a - b| / b
double difference(const std::array<double, 3>& a, const std::array<double, 3>& b) {
  double d = 0;
  for (int j = 0; j < 3; ++j) d = std::max(d, std::abs(a[j] - b[j]) / b[j]);
  return d;
}

struct Table3 : testing::Test {
  const std::vector<study::Table3Row> printed = study::table3_printed();
  const std::vector<study::Table3Row> panel = study::table3_measured(150),
                                      bare = study::table3_measured(0);
  // rows of the printed and of the measured tables
  static constexpr int kPrintedRise = 0, kPrintedSettling = 1, kRise = 0, kRise090 = 1,
                       kSettling = 2;
};

TEST_F(Table3, PrintsRiseTimesAboveSettlingTimesWhichNoSignalCanHave) {
  for (int j = 0; j < 3; ++j)
    EXPECT_GT(printed[kPrintedRise].ndob[j], printed[kPrintedSettling].ndob[j]);
  EXPECT_GT(printed[kPrintedRise].ekf[2], printed[kPrintedSettling].ekf[2]);
  for (const auto& measured : {panel, bare}) {
    for (int j = 0; j < 3; ++j) {
      EXPECT_LT(measured[kRise090].ekf[j], measured[kSettling].ekf[j]);
      EXPECT_LT(measured[kRise090].ndob[j], measured[kSettling].ndob[j]);
    }
  }
}

TEST_F(Table3, NdobRiseIsTheTimeTo90PercentWithThePanel) {
  EXPECT_LT(difference(panel[kRise090].ndob, printed[kPrintedRise].ndob), 0.05);
  EXPECT_GT(difference(bare[kRise090].ndob, printed[kPrintedRise].ndob), 0.5);
}

TEST_F(Table3, NdobSettlingIsThatWithoutThePanel) {
  EXPECT_LT(difference(bare[kSettling].ndob, printed[kPrintedSettling].ndob), 0.15);
  EXPECT_GT(difference(panel[kSettling].ndob, printed[kPrintedSettling].ndob), 0.5);
}

TEST_F(Table3, EkfRowsAreReproducedByNeitherReading) {
  for (const auto& measured : {panel, bare}) {
    EXPECT_GT(difference(measured[kRise].ekf, printed[kPrintedRise].ekf), 0.5);
    EXPECT_GT(difference(measured[kRise090].ekf, printed[kPrintedRise].ekf), 0.5);
    EXPECT_GT(difference(measured[kSettling].ekf, printed[kPrintedSettling].ekf), 0.5);
  }
}

}  // namespace
}  // namespace tauext::test
