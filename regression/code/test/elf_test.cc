// SPDX-License-Identifier: Apache-2.0
#include "regression/code/elf.h"

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

TEST(Elf, NamesTheLibrariesThatAProgramNeeds) {
  const std::vector<std::string> needed = needed_libraries(this_program());
  EXPECT_NE(std::find(needed.begin(), needed.end(), "libc.so.6"), needed.end());
}

TEST(Elf, NamesTheFunctionAtAnAddress) {
  const std::string program = this_program();
  EXPECT_THROW(function_at(program, 1), std::runtime_error);
  const Finished nm = finish_child({"nm", program});
  const auto at = nm.output.find(" T main\n");
  ASSERT_NE(at, std::string::npos);
  const auto line = nm.output.rfind('\n', at) + 1;
  EXPECT_EQ(function_at(program, std::stoull(nm.output.substr(line, at - line), nullptr, 16)),
            "main");
}

TEST(Elf, RefusesWhatIsNoProgramByName) {
  const TemporaryFolder folder;
  const std::string path = folder.path() + "/x.so", whole = read_whole(this_program());
  const auto error = [&](const std::string& text) {
    std::ofstream(path, std::ios::binary) << text;
    return error_of([&] { needed_libraries(path); });
  };
  EXPECT_EQ(error(""), path + ": no ELF file of 64 bit");
  EXPECT_EQ(error("#!/bin/sh"), path + ": no ELF file of 64 bit");
  EXPECT_EQ(error(whole.substr(0, whole.size() / 2)), path + ": an ELF file that is cut off");
  EXPECT_EQ(error_of([] { needed_libraries("/nowhere"); }), "/nowhere: No such file or directory");
}

}  // namespace
}  // namespace tauext::gate
