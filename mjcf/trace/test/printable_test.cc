// SPDX-License-Identifier: Apache-2.0
#include "mjcf/trace/printable.h"

#include <gtest/gtest.h>

#include <random>
#include <string>

#include "mjcf/trace/table_writer.h"

namespace tauext::test {
namespace {

TEST(PrintableTest, TextStaysAndControlSequencesDoNot) {
  EXPECT_EQ(printable("Gelenk größer als 3 \xE2\x80\xA6 \xF0\x9F\xA4\x96\nnext"),
            "Gelenk größer als 3 \xE2\x80\xA6 \xF0\x9F\xA4\x96\nnext");
  EXPECT_EQ(printable("\x1B]0;title\x07\x7F\r\t"), "?]0;title????");
  EXPECT_EQ(printable("\xC2\x9B"
                      "31m"),
            "??31m");                                     // C1: a control sequence in two bytes
  EXPECT_EQ(printable("\xC0\x9B\xE0\x80\x9B"), "?????");  // the same, overlong
  EXPECT_EQ(printable("\xED\xA0\x80\xF5\x80\x80\x80\xE2\x80"), "?????????");
  EXPECT_EQ(printable("a\xE2\x80\xAE"
                      "b"),
            "a???b");  // would turn the direction of writing
  EXPECT_EQ(printable_name("a\nb\x1B"), "a?b?");
  EXPECT_EQ(one_line("\na\n\nb\x1B\n"), "a; b?");
  EXPECT_EQ(one_line("\n"), "");
  EXPECT_EQ(one_line("abcdef", 3), "abc ..");
  EXPECT_EQ(printable_name(std::string(100, 'x')).size(), 60u);
}

TEST(PrintableTest, NoRandomTextHoldsAControlByte) {
  std::mt19937_64 random(5);
  for (int i = 0; i < 10'000; ++i) {
    std::string text(random() % 40, ' ');
    for (char& c : text) c = static_cast<char>(random());
    const std::string safe = printable_name(text);
    for (std::size_t k = 0; k < safe.size(); ++k) {
      const auto byte = static_cast<unsigned char>(safe[k]);
      ASSERT_TRUE(byte >= 0x20 && byte != 0x7F);
      const bool c1 = byte == 0xC2 && static_cast<unsigned char>(safe[k + 1]) < 0xA0;
      ASSERT_FALSE(c1);
    }
    ASSERT_EQ(printable(safe), safe);
  }
}

TEST(PrintableTest, TablesArePrintable) {
  TableWriter table({{"name", "", true}});
  table.add({"\x1B[2J"});
  table.add_note("\x1B[2J");
  EXPECT_EQ(table.format().find('\x1B'), std::string::npos);
}

}  // namespace
}  // namespace tauext::test
