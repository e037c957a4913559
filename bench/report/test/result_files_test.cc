// SPDX-License-Identifier: Apache-2.0
#include "bench/report/result_files.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>

namespace tauext {
namespace {

std::string error_of(const std::string& text) {
  try {
    checked_result("f.json", text);
  } catch (const std::runtime_error& e) {
    return e.what();
  }
  return "";
}

void expect_error(const std::string& text, const std::string& words) {
  EXPECT_NE(error_of(text).find("f.json: " + words), std::string::npos) << error_of(text);
}

TEST(ResultFiles, SayWhichElementIsWrong) {
  expect_error("{", "no JSON: ");
  expect_error("[1]", "no file of results: \"format\" is not there, and must be one of ");
  expect_error(R"({"format": "tauext-seeds-2"})",
               "no file of results: \"format\" is \"tauext-seeds-2\"");
  expect_error(
      R"({"benchmarks": [{"name": "a/b/c"}]})",
      "all of it is {\"benchmarks\":[{\"name\":\"a/b/c\"}]}: Missing required property 'context'");
  expect_error(R"({"context": {}, "benchmarks": []})", "/benchmarks is []: ");
  expect_error(R"({"context": {}, "benchmarks": [{"name": "a/b/c", "rmse_Nm": -1}]})",
               "/benchmarks/0/rmse_Nm is -1: ");
  expect_error(R"({"context": {}, "benchmarks": [{"name": "a/b/c"}, {"name": "ab"}]})",
               "/benchmarks/1/name is \"ab\": ");
  expect_error(R"({"context": {}, "benchmarks": [{"name": "a/b/c", "rmse_Nm": "7"}]})",
               "/benchmarks/0/rmse_Nm is \"7\": ");
  expect_error(R"({"context": {}, "benchmarks": [{"name": "a/b/c", "rmse_Nm_joint2": []}]})",
               "/benchmarks/0/rmse_Nm_joint2 is []: ");
  expect_error(R"({"context": {"submitter": 7}, "benchmarks": [{"name": "a/b/c"}]})",
               "/context/submitter is 7: ");
  expect_error(R"({"context": {}, "benchmarks": [], "benchmarks": []})", "the key");
  expect_error(R"({"format": "tauext-traces-1", "context": {}, "groups": [{"name": "a/b", "t": [],
                   "contacts": [], "marks": [], "series": [{"name": "truth", "joints":
                   [{"low": 0, "high": 1, "values": "<"}]}]}]})",
               "/groups/0/series/0/joints/0/values is \"<\": ");
}

TEST(ResultFiles, TracesHaveAValueForEachTime) {
  const auto traces = [](const std::string& values, const std::string& more = "") {
    return R"({"format": "tauext-traces-1", "context": {}, "groups": [{"name": "a/b", "t": [0, 1],
               "contacts": [], "marks": [], "series": [{"name": "truth", "joints":
               [{"low": 0, "high": 1, "values": ")" +
           values + "\"}]" + more + "}]}]}";
  };
  EXPECT_EQ(error_of(traces("AAD//w==")), "") << "0 and 65535";
  expect_error(traces("AAA="), "\"joints\" of \"truth\" in \"a/b\" are not 1 signals of 2 values");
  expect_error(traces("AAD//w==", R"(, "wrench": [{"low": 0, "high": 1, "values": "AAA="}])"),
               "\"wrench\" of \"truth\" in \"a/b\" are not 1 signals of 2 values");
}

TEST(ResultFiles, AreKnownByWhatTheyHold) {
  const auto kind = [](const std::string& text) { return checked_result("f", text).kind; };
  EXPECT_EQ(kind(R"({"context": {}, "benchmarks": [{"name": "a/b/c", "rmse_Nm": 1}]})"), "suite");
  EXPECT_EQ(kind(R"({"format": "tauext-seeds-1", "context": {}, "rows": []})"), "seeds");
  EXPECT_EQ(kind(R"({"format": "tauext-detection-1", "context": {}, "cells": []})"), "study");
}

TEST(ResultFiles, TheSchemaKnowsEveryMetric) {
  const auto schema = nlohmann::json::parse(results_schema());
  const auto& row = schema["definitions"]["suite"]["properties"]["benchmarks"]["items"];
  EXPECT_EQ(row["properties"]["rmse_Nm"]["type"], "number");
  EXPECT_EQ(row["properties"]["delay_s"]["type"], "number");
  EXPECT_TRUE(row["patternProperties"].contains("^rmse_Nm_joint[1-9]$"));
}

TEST(ResultFiles, OfAHistoryTheLineThatIsBrokenIsNamed) {
  try {
    checked_result("h.jsonl", "{\"a\": 1}\n{\"b\":\n");
    FAIL();
  } catch (const std::runtime_error& e) {
    EXPECT_EQ(std::string(e.what()).find("h.jsonl: line 2: "), 0u) << e.what();
    EXPECT_EQ(std::string(e.what()).find("line 1"), std::string::npos) << e.what();
  }
}

TEST(ResultFiles, NumbersAreThoseOfTheFile) {
  const std::string text =
      R"({"context":{},"benchmarks":[{"name":"a/b/c","rmse_Nm":0.1234567890123456789}]})";
  const auto json = nlohmann::json::parse(checked_result("f", text).json);
  EXPECT_EQ(json["benchmarks"][0]["rmse_Nm"].get<double>(), 0.1234567890123456789);
}

}  // namespace
}  // namespace tauext
