// SPDX-License-Identifier: Apache-2.0
// What tauext-gate explain prints can be run, and scores the entry; what is gone is told.
#include <fmt/format.h>

#include <string>
#include <vector>

#include "regression/test/gate_fixture.h"

namespace tauext::gate::test {
namespace {

class Explain : public Gate {
 protected:
  // the command among what was printed that begins like that
  std::string printed(const std::string& begin) const {
    const auto at = text_.find("\n  " + begin);
    if (at == std::string::npos) ADD_FAILURE() << begin << " is not in\n" << text_;
    return at == std::string::npos ? "false"
                                   : text_.substr(at + 3, text_.find('\n', at + 1) - at - 3);
  }
  std::string in_folder(const std::string& command) const {
    return run_child(
        {"sh", "-c", "cd '" + folder_.path() + "' && PATH='" + kBin + "':$PATH && " + command});
  }
};

// in the first a detector's mark stops the motor
TEST_F(Explain, PrintsACommandThatReproducesTheEntry) {
  for (const std::string entry : {"testbed1/collision/ekf+pan_tompkins", "wallmobot3/step/ndob"}) {
    ASSERT_EQ(run({"explain", entry, "--baselines", baselines()}), kGood) << text_;
    const Golden golden = parse_golden(in_folder(printed(kBin + "/tauext-bench ")), "golden");
    ASSERT_EQ(golden.seeds, std::vector<std::string>{"seed 1"});
    const double rmse = golden.lines.at({entry, "rmse_Nm"}).values.at(0);
    EXPECT_TRUE(says(fmt::format("{:.9g}", rmse))) << rmse << text_;
  }
}

TEST_F(Explain, SaysThatAKernelIsGoneFromHead) {
  EXPECT_EQ(run({"explain", "testbed1/mo1", "--base", kBin + "/tauext_plugin.so", "--head",
                 plugin("base"), "--baselines", baselines()}),
            kGood)
      << text_;
  EXPECT_TRUE(says("testbed1/mo1 is gone from head: base alone has it")) << text_;
}

}  // namespace
}  // namespace tauext::gate::test
