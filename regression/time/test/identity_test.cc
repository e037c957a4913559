// SPDX-License-Identifier: Apache-2.0
#include "regression/time/identity.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>

#include "mjcf/test/error_of.h"
#include "mjcf/trace/input_file.h"
#include "regression/host/child.h"
#include "regression/host/files.h"

namespace tauext::gate {
namespace {

using tauext::test::error_of;

// lies in .rodata
[[gnu::used]] const char kNeedle[] = "a needle that stands in this program alone";

TEST(Identity, OfAProgramWithItselfAndWithOneByteChanged) {
  const TemporaryFolder folder;
  const std::string copy = folder.copy(this_program(), "copy");
  EXPECT_TRUE(identical(this_program(), copy));
  std::string bytes = read_whole(copy);
  const auto at = bytes.find(kNeedle);
  ASSERT_NE(at, std::string::npos);
  bytes[at] = 'A';
  std::ofstream(copy, std::ios::binary) << bytes;
  EXPECT_FALSE(identical(this_program(), copy));
}

TEST(Identity, NamesTheLibrariesThatAProgramNeeds) {
  const std::vector<std::string> needed = needed_libraries(this_program());
  EXPECT_NE(std::find(needed.begin(), needed.end(), "libc.so.6"), needed.end());
}

TEST(Identity, RefusesWhatIsNoProgramByName) {
  const TemporaryFolder folder;
  const std::string path = folder.path() + "/x.so", whole = read_whole(this_program());
  const auto error = [&](const std::string& text) {
    std::ofstream(path, std::ios::binary) << text;
    return error_of([&] { identical(path, path); });
  };
  EXPECT_EQ(error(""), path + ": no ELF file of 64 bit");
  EXPECT_EQ(error("#!/bin/sh"), path + ": no ELF file of 64 bit");
  EXPECT_EQ(error(whole.substr(0, whole.size() / 2)), path + ": an ELF file that is cut off");
  EXPECT_EQ(error_of([] { identical("/nowhere", "/nowhere"); }),
            "/nowhere: No such file or directory");
}

}  // namespace
}  // namespace tauext::gate
