// SPDX-License-Identifier: Apache-2.0
#include "mjcf/trace/text.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <limits>

namespace tauext::test {
namespace {

using Parts = std::vector<std::string_view>;

TEST(Text, ANumberIsTheWholeText) {
  EXPECT_EQ(number_in<int>("-12"), -12);
  EXPECT_EQ(number_in<std::uint64_t>("18446744073709551615"), 18446744073709551615u);
  EXPECT_EQ(number_in<double>("-1.5e3"), -1500);
  for (const char* other : {"", " ", "-", "1 ", " 1", "+1", "1x", "x1", "1,5", "0x10", "1\n"}) {
    EXPECT_EQ(number_in<int>(other), std::nullopt) << other;
    EXPECT_EQ(number_in<double>(other), std::nullopt) << other;
  }
  EXPECT_EQ(number_in<int>("1.5"), std::nullopt);
  EXPECT_EQ(number_in<unsigned>("-1"), std::nullopt);
  EXPECT_EQ(number_in<int>(std::string_view("123").substr(0, 2)), 12) << "not what stands behind";
}

TEST(Text, ANumberOutOfRangeIsNone) {
  EXPECT_EQ(number_in<int>("2147483648"), std::nullopt);
  EXPECT_EQ(number_in<std::uint64_t>("18446744073709551616"), std::nullopt);
  EXPECT_EQ(number_in<double>("1e999"), std::nullopt);
  EXPECT_EQ(number_in<double>("1e-999"), std::nullopt);
}

TEST(Text, InfinityAndNanAreNumbersButNotFinite) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  EXPECT_EQ(number_in<double>("inf"), kInfinity);
  EXPECT_EQ(number_in<double>("-Infinity"), -kInfinity);
  EXPECT_TRUE(std::isnan(number_in<double>("nan").value()));
  for (const char* other : {"inf", "-inf", "nan", "1e999", ""})
    EXPECT_EQ(finite_number_in(other), std::nullopt) << other;
  EXPECT_EQ(finite_number_in("0.25"), 0.25);
}

TEST(Text, BlanksAroundItGo) {
  EXPECT_EQ(without_blanks(" \ta b\t\r"), "a b");
  EXPECT_EQ(without_blanks("\na"), "\na");
  EXPECT_EQ(without_blanks(" \t\r"), "");
  EXPECT_EQ(without_blanks(""), "");
}

TEST(Text, PartsAreOneMoreThanSeparators) {
  EXPECT_EQ(split("a,bc,d", ','), (Parts{"a", "bc", "d"}));
  EXPECT_EQ(split(",a,,", ','), (Parts{"", "a", "", ""}));
  EXPECT_EQ(split("a", ','), Parts{"a"});
  EXPECT_EQ(split("", ','), Parts{""});
}

TEST(Text, SmallLettersStandForCapitalOnes) {
  EXPECT_EQ(in_small_letters("AZaz-09_\xC3\x84"), "azaz-09_\xC3\x84");
}

}  // namespace
}  // namespace tauext::test
