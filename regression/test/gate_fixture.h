// SPDX-License-Identifier: Apache-2.0
// tauext-gate run as a CI service runs it, on plug-ins and on a suite whose faults are known.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "bench/program/exit_code.h"
#include "regression/accuracy/accuracy_layer.h"
#include "regression/host/child.h"
#include "regression/host/files.h"
#include "regression/memory/acceptance.h"

namespace tauext::gate::test {

namespace fs = std::filesystem;

inline const std::string kBin = fs::absolute(TAUEXT_BIN);  // for programs in other folders
inline constexpr const char* kEntries = "testbed1/hold/subject$";

inline std::string plugin(const std::string& name) {
  return kBin + "/subject_" + name + ".so";
}

class Gate : public testing::Test {
 protected:
  // what it says goes to text_
  int run(const std::vector<std::string>& args, const std::string& fault = "") {
    // env runs it, so that the fault reaches the bench program
    std::vector<std::string> argv = {"sh", "-c", "exec env SUBJECT=\"$0\" \"$@\" 2>&1", fault,
                                     kBin + "/tauext-gate"};
    argv.insert(argv.end(), args.begin(), args.end());
    const Finished f = finish_child(argv);
    text_ = f.output;
    return f.code;
  }
  // that it could not run, and said why
  void refuses(const std::vector<std::string>& args, const std::string& why) {
    EXPECT_EQ(run(args), kCouldNotRun) << text_;
    EXPECT_TRUE(says(why)) << text_;
  }
  bool says(const std::string& what) const { return text_.find(what) != std::string::npos; }

  int time(const std::string& head, const std::string& base = "base") {
    return run({"time", "--base", plugin(base), "--head", plugin(head)});
  }
  int count(const std::string& head) {
    return run(
        {"count", "--base", plugin("base"), "--head", plugin(head), "--baselines", baselines()});
  }
  int accuracy(const std::string& fault, const std::string& entries = kEntries) {
    return run({"accuracy", "--bench", kBin + "/subject_bench", "--baselines", baselines(),
                "--entries", entries},
               fault);
  }
  std::string baselines() const { return folder_.path(); }
  std::string golden() const { return golden_path(baselines()); }

  void make_golden(const std::string& fault = "") const {
    run_child({"env", "SUBJECT=" + fault, kBin + "/subject_bench", "--golden", golden(),
               std::string("--benchmark_filter=") + kEntries});
  }
  // the path of the file that update writes
  std::string make_counts() {
    run({"update", "--bench", "", "--head", plugin("base"), "--baselines", baselines(),
         "--changelog", baselines() + "/log.md", "--reason", "the first"});
    for (const auto& entry : fs::directory_iterator(baselines())) {
      if (entry.path().filename().string().starts_with("instructions-")) return entry.path();
    }
    ADD_FAILURE() << text_;
    return "";
  }
  void write(const std::string& path, const std::string& text) const {
    std::ofstream(path) << text;
  }

  TemporaryFolder folder_;
  std::string text_;  // what the last run said
};

}  // namespace tauext::gate::test
