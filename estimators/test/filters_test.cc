// SPDX-License-Identifier: Apache-2.0
#include "estimators/detectors/filters.h"

#include <gtest/gtest.h>

#include <limits>
#include <random>

#include "estimators/detectors/marking.h"

namespace tauext::test {
namespace {

TEST(LowPass, AnswersAStepByOneMinusExpAtAnySpacing) {
  std::mt19937_64 generator(3);
  for (const double h : {1e-3, 3e-3, 0.}) {  // 0: uneven
    LowPass low(1, 20);
    low.start(0, Vec<1>(0));
    low.advance(1e-9);
    low(0, 1);  // held from here on
    for (double t = 1e-9; t < 0.3;) {
      t += h > 0 ? h : 1e-4 + 4e-3 * static_cast<double>(generator() >> 11) * 0x1p-53;
      low.advance(t);
      EXPECT_NEAR(low(0, 1), -std::expm1(-20 * (t - 1e-9)), 1e-9);
    }
  }
}

TEST(LowPass, StartsAsIfItsInputHadBeenThereForEver) {
  LowPass low(2, 5);
  low.start(1, Vec<2>(3, -4));
  low.advance(1.5);
  EXPECT_EQ(low(0, 3), 3);
  EXPECT_EQ(low(1, -4), -4);
}

TEST(LowPass, RefusesACutOffOfZero) {
  EXPECT_THROW(LowPass(1, 0), std::invalid_argument);
}

TEST(Marking, MarksARiseThroughOneAndNotTheStay) {
  Marking m(0.1, 0);
  EXPECT_FALSE(m(0, 0.9, Contact::kCollision).mark);
  const Detection d = m(0.01, 1, Contact::kClamping);
  EXPECT_TRUE(d.mark);
  EXPECT_EQ(d.contact, Contact::kClamping);
  EXPECT_FALSE(m(0.02, 5, Contact::kCollision).mark);
}

TEST(Marking, MarksNoSecondRiseWithinItsRefractoryTime) {
  Marking m(0.1, 0);
  m(0, 0, Contact::kCollision);
  EXPECT_TRUE(m(0.01, 2, Contact::kCollision).mark);
  m(0.02, 0, Contact::kCollision);
  EXPECT_FALSE(m(0.05, 2, Contact::kCollision).mark);
  m(0.06, 0, Contact::kCollision);
  EXPECT_TRUE(m(0.12, 2, Contact::kCollision).mark);
}

TEST(Marking, IsSilentAtTheBeginAndMarksWhatIsThereWhenTheSilenceEnds) {
  Marking m(0.1, 1);
  for (double t = 10; t < 10.99; t += 0.1) {
    EXPECT_TRUE(m.silent(t));
    EXPECT_FALSE(m(t, 9, Contact::kCollision).mark);
  }
  EXPECT_TRUE(m(11.05, 9, Contact::kCollision).mark);
  m.reset();
  EXPECT_FALSE(m(12, 9, Contact::kCollision).mark) << "and again after a reset";
}

TEST(Marking, RefusesTimesThatAreNoneOrNoLater) {
  Marking m(0.1, 0);
  EXPECT_TRUE(m.accept(5));
  m(5, 0.3, Contact::kCollision);
  for (const double t : {5., 4.9, std::numeric_limits<double>::quiet_NaN(),
                         std::numeric_limits<double>::infinity()}) {
    EXPECT_FALSE(m.accept(t)) << t;
  }
  EXPECT_EQ(m.held().score, 0.3);
  EXPECT_THROW(Marking(-1, 0), std::invalid_argument);
  EXPECT_THROW(Marking(0, -1), std::invalid_argument);
}

}  // namespace
}  // namespace tauext::test
