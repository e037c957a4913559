// SPDX-License-Identifier: Apache-2.0
#include "bench/report/page.h"

#include <gtest/gtest.h>

#include <fstream>
#include <stdexcept>

namespace tauext::report {
namespace {

const std::string kHostile =
    R"({"context":{"submitter":"</script><script>alert(1)</script><!--"},"benchmarks":[{"name":"a/b/c"}]})";

TEST(Page, HoldsItsFilesAsTheyAre) {
  const std::vector<ResultFile> files = {
      checked_result("one.json", kHostile),
      checked_result("two.json", R"({"format":"tauext-seeds-1","context":{},"rows":[]})")};
  const std::string path = testing::TempDir() + "page.html";
  std::ofstream(path) << page_of(files);
  const std::vector<ResultFile> read = read_results(path);
  ASSERT_EQ(read.size(), 2);
  EXPECT_EQ(read[0].name, "one.json");
  EXPECT_EQ(read[0].json, files[0].json);
  EXPECT_EQ(read[1].kind, "seeds");
}

TEST(Page, NoTextOfAFileEndsItsScript) {
  const std::string page = page_of({checked_result("one.json", kHostile)});
  const std::string bare = page_of({});
  const auto scripts = [](const std::string& p) {
    int n = 0;
    for (std::size_t at = 0; (at = p.find("</script", at)) != p.npos; ++at) ++n;
    return n;
  };
  EXPECT_EQ(scripts(page), scripts(bare));
}

TEST(Page, AsksForNothing) {
  const std::string page = page_of({});
  EXPECT_NE(page.find("default-src 'none'"), page.npos);
  for (const char* asks : {" src=", "@import", "fetch(", "XMLHttpRequest", "import("})
    EXPECT_EQ(page.find(asks), page.npos) << asks;
  EXPECT_EQ(page.find("@["), page.npos) << "a part is missing";
}

TEST(Page, AnyOtherPageIsRefused) {
  const std::string path = testing::TempDir() + "other.html";
  std::ofstream(path) << "<html></html>";
  EXPECT_THROW(read_results(path), std::runtime_error);
  std::ofstream(path)
      << R"(<script type="application/json" id="results">[{"name": "x"}]</script></html>)";
  try {
    read_results(path);
    ADD_FAILURE() << "a page without data";
  } catch (const std::runtime_error& e) {
    EXPECT_EQ(std::string(e.what()).find(path + ": what it holds: "), 0u) << e.what();
  }
  std::ofstream(path) << page_of({checked_result("one.json", kHostile)}).substr(0, 60000);
  try {
    read_results(path);
    ADD_FAILURE() << "a page that was cut off";
  } catch (const std::runtime_error& e) {
    EXPECT_EQ(e.what(), path + ": a report whose end is missing; write or copy it again");
  }
}

}  // namespace
}  // namespace tauext::report
