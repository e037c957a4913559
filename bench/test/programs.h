// SPDX-License-Identifier: Apache-2.0
// A fixture that runs the programs in a folder of its own.
#pragma once

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

namespace tauext::test {

namespace fs = std::filesystem;

// absolute, because programs run in a folder of their own; tests start at the top of the tree
inline const std::string kBin = fs::absolute(TAUEXT_BIN);
inline const std::string kExamples = fs::absolute("bench/examples");
inline const std::string kMjcf = fs::absolute("mjcf");

struct Outcome {
  int code;
  std::string text;  // standard output and standard error
  bool says(const std::string& what) const { return text.find(what) != std::string::npos; }
};

class Programs : public testing::Test {
 protected:
  Programs() : folder_(fs::temp_directory_path() / ("tauext_cli_" + std::to_string(::getpid()))) {
    fs::create_directories(folder_);
    ::unsetenv("LCM_DEFAULT_URL");  // whoever runs the tests may have one
  }
  ~Programs() override { fs::remove_all(folder_); }

  // one of tauext's programs, with its arguments
  Outcome run(const std::string& command) const { return run_system(kBin + "/" + command); }
  // any other
  Outcome run_system(const std::string& command) const {
    const std::string line = "cd " + folder_.string() + " && (" + command + ") 2>&1";
    std::FILE* const pipe = ::popen(line.c_str(), "r");
    Outcome o{-1, ""};
    std::array<char, 4096> buffer;
    for (std::size_t n; (n = std::fread(buffer.data(), 1, buffer.size(), pipe)) > 0;)
      o.text.append(buffer.data(), n);
    const int status = ::pclose(pipe);
    o.code = WIFEXITED(status) ? WEXITSTATUS(status) : 128;
    return o;
  }
  std::string content(const std::string& name) const {
    std::ostringstream out;
    out << std::ifstream(folder_ / name).rdbuf();
    return out.str();
  }
  void write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name) << text;
  }
  bool exists(const std::string& name) const { return fs::exists(folder_ / name); }

  fs::path folder_;
};

inline constexpr const char* kFirstTable = "../bench/run/suite/tauext-first-table";  // from kBin
inline constexpr const char* kQuick = " --benchmark_min_time=0.001";

}  // namespace tauext::test
