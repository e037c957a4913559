// SPDX-License-Identifier: Apache-2.0
#include "mjcf/trace/byte_order.h"

#include <gtest/gtest.h>

#include <string>

namespace tauext::test {
namespace {

constexpr std::endian kBig = std::endian::big, kLittle = std::endian::little;
constexpr unsigned char kBytes[] = {0x81, 0x02, 0x03, 0x04, 0x05, 0x06, 0x07, 0xF8};

TEST(ByteOrder, TheFirstByteIsTheLowestOrTheHighest) {
  static_assert(from_bytes(kBytes, 0) == 0);
  static_assert(from_bytes(kBytes, 1) == 0x81 && from_bytes(kBytes, 1, kBig) == 0x81);
  static_assert(from_bytes(kBytes, 2) == 0x0281 && from_bytes(kBytes, 2, kBig) == 0x8102);
  static_assert(from_bytes(kBytes, 4, kLittle) == 0x04030281);
  static_assert(from_bytes(kBytes, 4, kBig) == 0x81020304);
  static_assert(from_bytes(kBytes, 8) == 0xF807060504030281);
  static_assert(from_bytes(kBytes, 8, kBig) == 0x81020304050607F8);
}

TEST(ByteOrder, BytesOfAnyTypeHaveNoSign) {
  constexpr char kSigned[] = {'\x80', '\xFF'};
  constexpr std::byte kPlain[] = {std::byte{0x80}, std::byte{0xFF}};
  static_assert(from_bytes(kSigned, 2) == 0xFF80 && from_bytes(kPlain, 2) == 0xFF80);
}

TEST(ByteOrder, NumbersAreWrittenByTheirLowBytes) {
  EXPECT_EQ(to_bytes(0x0102, 2), "\2\1");
  EXPECT_EQ(to_bytes(0x0102, 2, kBig), "\1\2");
  EXPECT_EQ(to_bytes(0xABCDEF, 1), "\xEF");
  EXPECT_EQ(to_bytes(0xABCDEF, 2, kBig), "\xCD\xEF");
  EXPECT_EQ(to_bytes(7, 4), std::string("\7\0\0\0", 4));
  EXPECT_EQ(to_bytes(7, 4, kBig), std::string("\0\0\0\7", 4));
  EXPECT_EQ(to_bytes(0x81020304050607F8, 8), "\xF8\7\6\5\4\3\2\x81");
  EXPECT_EQ(to_bytes(0x81020304050607F8, 8, kBig), "\x81\2\3\4\5\6\7\xF8");
}

}  // namespace
}  // namespace tauext::test
