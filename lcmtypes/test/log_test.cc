// SPDX-License-Identifier: Apache-2.0
#include "lcmtypes/log.h"

#include <gtest/gtest.h>
#include <lcm/eventlog.h>
#include <unistd.h>

#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>

#include "lcmtypes/test/samples.h"

namespace tauext::test {
namespace {

namespace fs = std::filesystem;

class LogTest : public testing::Test {
 protected:
  LogTest()
      : path_(fs::temp_directory_path() / ("tauext_log_" + std::to_string(::getpid()) + ".lcm")) {}
  ~LogTest() override { fs::remove(path_); }

  // samples first to last - 1
  static std::string log_of(int first, int last) {
    LogBuffer log;
    for (int k = first; k < last; ++k) {
      log.append("TAUEXT_SAMPLE", 1000 * k, write(reading(k), MessageType::kTauext));
    }
    return std::string(log.bytes());
  }
  void put(const std::string& bytes) const { std::ofstream(path_, std::ios::binary) << bytes; }

  // numbers of the samples that are read
  std::vector<std::int64_t> read_back() {
    std::vector<std::int64_t> seqs;
    faults_ = read_log(path_.string(), [&](const LogEvent& e) {
      Reading r;
      EXPECT_EQ(read(e.message, MessageType::kTauext, r), Reject::kNone);
      EXPECT_EQ(e.channel, "TAUEXT_SAMPLE");
      EXPECT_EQ(e.utime, r.utime);
      seqs.push_back(r.seq);
    });
    return seqs;
  }
  static std::vector<std::int64_t> numbers(int first, int last) {
    std::vector<std::int64_t> all;
    for (int k = first; k < last; ++k) all.push_back(k);
    return all;
  }

  fs::path path_;
  LogFaults faults_;
};

TEST_F(LogTest, WhatWasAppendedIsReadBack) {
  put(log_of(0, 1000));
  EXPECT_EQ(read_back(), numbers(0, 1000));
  EXPECT_EQ(faults_.junk_bytes, 0);
  EXPECT_FALSE(faults_.truncated);
}

TEST_F(LogTest, LcmsOwnReaderReadsTheSame) {
  put(log_of(0, 100));
  lcm_eventlog_t* const log = lcm_eventlog_create(path_.c_str(), "r");
  ASSERT_NE(log, nullptr);
  int k = 0;
  while (lcm_eventlog_event_t* const e = lcm_eventlog_read_next_event(log)) {
    EXPECT_EQ(e->eventnum, k);
    EXPECT_EQ(e->timestamp, 1000 * k);
    EXPECT_STREQ(e->channel, "TAUEXT_SAMPLE");
    ++k;
    lcm_eventlog_free_event(e);
  }
  lcm_eventlog_destroy(log);
  EXPECT_EQ(k, 100);
}

TEST_F(LogTest, LcmsOwnWriterWritesTheSameBytes) {
  const std::string ours = log_of(0, 3);
  {
    lcm_eventlog_t* const log = lcm_eventlog_create(path_.c_str(), "w");
    ASSERT_NE(log, nullptr);
    for (int k = 0; k < 3; ++k) {
      auto message = write(reading(k), MessageType::kTauext);
      std::string channel = "TAUEXT_SAMPLE";
      lcm_eventlog_event_t e{};
      e.timestamp = 1000 * k;
      e.channellen = static_cast<std::int32_t>(channel.size());
      e.datalen = static_cast<std::int32_t>(message.size());
      e.channel = channel.data();
      e.data = const_cast<std::byte*>(message.data());
      ASSERT_EQ(lcm_eventlog_write_event(log, &e), 0);
    }
    lcm_eventlog_destroy(log);
  }
  std::ostringstream theirs;
  theirs << std::ifstream(path_, std::ios::binary).rdbuf();
  EXPECT_EQ(theirs.str(), ours);
}

TEST_F(LogTest, TheSameEventsAreTheSameBytes) {
  const Reading r = reading(7);
  std::string logs[2];
  for (std::string& text : logs) {
    LogBuffer log;
    for (int k = 0; k < 500; ++k) {
      for (const MessageType type :
           {MessageType::kTauext, MessageType::kIiwa, MessageType::kPanda}) {
        log.append("TAUEXT_SAMPLE", k, write(r, type));
      }
    }
    text = log.bytes();
  }
  EXPECT_TRUE(logs[0] == logs[1]);
}

TEST_F(LogTest, JunkBetweenEventsIsSkippedAndCounted) {
  put("junk!" + log_of(0, 10) + std::string(70000, 'x') + log_of(10, 20) + "\xED\xA1\xDA");
  EXPECT_EQ(read_back(), numbers(0, 20));
  EXPECT_EQ(faults_.junk_bytes, 5 + 70000);
  EXPECT_EQ(faults_.junk_stretches, 2);
  EXPECT_TRUE(faults_.truncated);
}

TEST_F(LogTest, EveryCutEndsAfterTheLastWholeEvent) {
  const std::string whole = log_of(0, 3);
  const std::size_t event = whole.size() / 3;
  for (std::size_t size = event; size <= whole.size(); ++size) {
    put(whole.substr(0, size));
    EXPECT_EQ(read_back(), numbers(0, static_cast<int>(size / event))) << size;
    EXPECT_EQ(faults_.truncated, size % event != 0) << size;
  }
}

TEST_F(LogTest, AForgedLengthCostsItsOwnEventAlone) {
  for (const std::uint32_t length : {0u, 7u, 999u, 1u << 20, 0x7fffffffu, 0xffffffffu}) {
    for (const std::size_t field : {20u, 24u}) {  // of the channel, of the message
      std::string bytes = log_of(0, 10);
      const std::size_t event = bytes.size() / 10;
      for (int i = 0; i < 4; ++i) {
        bytes[4 * event + field + i] = static_cast<char>(length >> (24 - 8 * i));
      }
      put(bytes);
      std::vector<std::int64_t> good;
      faults_ = read_log(path_.string(), [&](const LogEvent& e) {
        Reading r;
        if (read(e.message, MessageType::kTauext, r) == Reject::kNone) good.push_back(r.seq);
      });
      std::vector<std::int64_t> expected = numbers(0, 10);
      expected.erase(expected.begin() + 4);
      EXPECT_EQ(good, expected) << length << " at " << field;
    }
  }
}

TEST_F(LogTest, LengthsThatLieDoNotTakeForever) {
  std::string header = log_of(0, 1).substr(0, 28);
  header[24] = 3;  // claims 48 MB
  std::string bytes = log_of(0, 1);
  while (bytes.size() < 4'000'000) bytes += header;
  put(bytes);
  const std::clock_t begin = std::clock();  // of the processor, whoever else has it
  EXPECT_EQ(read_back(), numbers(0, 1));
  // 0.05 s; once it was quadratic and took 8 s
  EXPECT_LT(std::clock() - begin, 3 * CLOCKS_PER_SEC);
}

TEST_F(LogTest, WhatIsNoLogIsAnErrorThatNamesIt) {
  const auto message = [&] {
    try {
      read_back();
    } catch (const std::runtime_error& e) {
      return std::string(e.what());
    }
    return std::string("no error");
  };
  EXPECT_NE(message().find(path_.string() + ": cannot read: No such file"), std::string::npos);
  for (const std::string& bytes :
       {std::string(), std::string("t,q1,qd1,tau1\n0,0,0,0\n"), std::string(100000, '\0')}) {
    put(bytes);
    EXPECT_NE(message().find(path_.string() + ": no LCM log"), std::string::npos) << bytes.size();
  }
}

}  // namespace
}  // namespace tauext::test
