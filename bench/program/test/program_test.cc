// SPDX-License-Identifier: Apache-2.0
#include "bench/program/program.h"

#include <gtest/gtest.h>

#include <CLI/CLI.hpp>
#include <functional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "bench/program/realtime.h"

namespace tauext::test {
namespace {

// what a program with a flag --n makes of these arguments, and what it says on standard error
std::pair<int, std::string> outcome(std::vector<std::string> arguments,
                                    const std::function<int()>& body) {
  CLI::App app("a program", "program");
  int n = 0;
  app.add_option("--n", n);
  std::vector<char*> argv;
  arguments.insert(arguments.begin(), "program");
  for (std::string& a : arguments) argv.push_back(a.data());
  testing::internal::CaptureStderr();
  testing::internal::CaptureStdout();
  const int code = run_program(app, static_cast<int>(argv.size()), argv.data(), body);
  testing::internal::GetCapturedStdout();
  return {code, testing::internal::GetCapturedStderr()};
}

TEST(Program, WhatGoesWrongIsAPrintableLineAndTwo) {
  const auto good = [] { return static_cast<int>(kInconclusive); };
  EXPECT_EQ(outcome({"--n", "3"}, good), std::pair(4, std::string()));
  EXPECT_EQ(outcome({"--help"}, good).first, 0);
  EXPECT_EQ(outcome({"--n", "x"}, good).first, 2);
  const auto [code, said] = outcome({}, []() -> int { throw std::runtime_error("a\x1B[2Jb"); });
  EXPECT_EQ(code, 2);
  EXPECT_EQ(said, "program: a?[2Jb\n");
}

TEST(Program, ANumberThatDoesNotFitIsNoWholeNumber) {
  EXPECT_EQ(whole_number("18446744073709551615"), "");
  for (const char* text : {"18446744073709551616", "-1", "1.5", "", "1x"}) {
    EXPECT_NE(whole_number(text), "") << text;
  }
}

TEST(Program, APriorityIsOneToNinetyNine) {
  EXPECT_THROW(Realtime{0}, std::invalid_argument);
  EXPECT_THROW(Realtime{100}, std::invalid_argument);
}

}  // namespace
}  // namespace tauext::test
