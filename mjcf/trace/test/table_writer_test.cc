// SPDX-License-Identifier: Apache-2.0
#include "mjcf/trace/table_writer.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <stdexcept>

namespace tauext::test {
namespace {

TableWriter example() {
  TableWriter t({{"name", "", true}, {"rmse", "N m"}, {"step", "ns"}});
  t.add({"mo1", "2.349*", "30.0"});
  t.add({"a|b,c", "never", "5.1"});
  return t;
}

TEST(TableWriter, AlignsDigitsWhetherMarkedOrNot) {
  EXPECT_EQ(example().format(),
            "name    rmse   step\n"
            "         N m     ns\n"
            "mo1    2.349*  30.0\n"
            "a|b,c  never    5.1\n");
}

TEST(TableWriter, CsvQuotesWhatHoldsACommaAndHasNoMarks) {
  EXPECT_EQ(example().format(TableFormat::kCsv),
            "name,rmse_Nm,step_ns\nmo1,2.349,30.0\n\"a|b,c\",never,5.1\n");
}

TEST(TableWriter, JsonIsReadByAnotherLibraryAndHasNullWhereThereIsNoValue) {
  const auto j = nlohmann::json::parse(example().format(TableFormat::kJson));
  ASSERT_EQ(j.size(), 2u);
  EXPECT_EQ(j[0]["rmse_Nm"], 2.349);
  EXPECT_TRUE(j[1]["rmse_Nm"].is_null());
  EXPECT_EQ(j[1]["name"], "a|b,c");
}

TEST(TableWriter, MarkdownAndLatexEscapeTheirOwnSigns) {
  EXPECT_EQ(example().format(TableFormat::kMarkdown),
            "| name | rmse [N m] | step [ns] |\n|---|--:|--:|\n| mo1 | **2.349** | 30.0 |\n"
            "| a\\|b,c | never | 5.1 |\n");
  TableWriter t({{"x_1", "%", true}});
  t.add({"5 %*"});
  EXPECT_EQ(t.format(TableFormat::kLatex),
            "\\begin{tabular}{l}\n\\hline\nx\\_1 \\\\\n\\% \\\\\n\\hline\n\\textbf{5 \\%} \\\\\n"
            "\\hline\n\\end{tabular}\n");
}

// two groups of a row, the second with a note and without a value
TableWriter grouped() {
  TableWriter t({{"name", "", true}, {"x", "s"}});
  t.add({"a", "1"});
  t.add_gap();
  t.add_note("b  FAILED: why");
  t.add({"c", ""});
  return t;
}

TEST(TableWriter, HasNotesAndGapsInTextAlone) {
  EXPECT_EQ(grouped().format(),
            "name  x\n"
            "      s\n"
            "a     1\n"
            "\n"
            "b  FAILED: why\n"
            "c\n");
  EXPECT_EQ(grouped().format(TableFormat::kCsv), "name,x_s\na,1\nc,\n");
  EXPECT_EQ(grouped().format(TableFormat::kMarkdown),
            "| name | x [s] |\n|---|--:|\n| a | 1 |\n| c |  |\n");
  EXPECT_EQ(
      grouped().format(TableFormat::kLatex),
      "\\begin{tabular}{lr}\n\\hline\nname & x \\\\\n & s \\\\\n\\hline\na & 1 \\\\\nc &  \\\\\n"
      "\\hline\n\\end{tabular}\n");
  EXPECT_EQ(grouped().format(TableFormat::kJson),
            "[\n  {\"name\": \"a\", \"x_s\": 1},\n  {\"name\": \"c\", \"x_s\": null}\n]\n");
}

TEST(TableWriter, RefusesARowOfAnotherLengthAndAnUnknownFormat) {
  TableWriter t({{"a"}, {"b"}});
  EXPECT_THROW(t.add({"1"}), std::logic_error);
  EXPECT_THROW(table_format("pdf"), std::invalid_argument);
  EXPECT_EQ(table_format("md"), TableFormat::kMarkdown);
}

}  // namespace
}  // namespace tauext::test
