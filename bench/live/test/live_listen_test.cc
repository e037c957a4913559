// SPDX-License-Identifier: Apache-2.0
#include "bench/live/live_listen.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <thread>

#include "bench/program/exit_code.h"
#include "lcmtypes/log.h"
#include "lcmtypes/test/samples.h"

namespace tauext::live::test {
namespace {

using namespace tauext::test;  // NOLINT(google-build-using-namespace): samples to try with
using nlohmann::json;

// takes what PlotJuggler gets; a busy machine may lose some of it
class DatagramReceiver {
 public:
  DatagramReceiver() {
    sockaddr_in place{};
    place.sin_family = AF_INET;
    place.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof place;
    EXPECT_EQ(::bind(fd_, reinterpret_cast<sockaddr*>(&place), size), 0);
    EXPECT_EQ(::getsockname(fd_, reinterpret_cast<sockaddr*>(&place), &size), 0);
    at_ = fmt::format("127.0.0.1:{}", ntohs(place.sin_port));
    reader_ = std::thread([this] {
      std::string part(1 << 16, '\0');
      for (ssize_t n = 0; (n = ::recv(fd_, part.data(), part.size(), 0)) > 0;)
        all_.push_back(part.substr(0, static_cast<std::size_t>(n)));
    });
  }
  ~DatagramReceiver() {
    stop();
    ::close(fd_);
  }
  DatagramReceiver(const DatagramReceiver&) = delete;
  DatagramReceiver& operator=(const DatagramReceiver&) = delete;

  const std::string& at() const { return at_; }
  std::vector<json> all() {  // what came before is read first
    stop();
    std::vector<json> parsed;
    for (const std::string& text : all_) parsed.push_back(json::parse(text));
    return parsed;
  }

 private:
  void stop() {
    ::shutdown(fd_, SHUT_RD);
    if (reader_.joinable()) reader_.join();
  }

  int fd_ = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  std::string at_;
  std::vector<std::string> all_;
  std::thread reader_;
};

// a log of messages, and what is handed on of it and printed
class Listening : public testing::Test {
 protected:
  template <class Message>
  void send(const std::string& channel, const Message& m) {
    log_.append(channel, 1, bytes_of(m));
  }
  // number and time of a joint torque by the estimator ekf
  void send(std::int64_t seq, std::int64_t utime, double tau_ext) {
    estimate_t e = estimate();
    e.seq = seq, e.utime = utime, e.t = static_cast<double>(utime) * 1e-6;
    e.tau_ext_hat[0] = tau_ext;
    send("TAUEXT_ESTIMATE_ekf", e);
  }
  void listen() {
    const std::string path = testing::TempDir() + fmt::format("listen_{}.lcm", ::getpid());
    std::ofstream(path, std::ios::binary) << log_.bytes();
    Options o;
    o.url = "file://" + path + "?speed=0";
    DatagramReceiver receiver;
    o.plotjuggler = receiver.at();
    testing::internal::CaptureStdout();
    EXPECT_EQ(run_listen(o), kGood);
    printed_ = testing::internal::GetCapturedStdout();
    handed_on_ = receiver.all();
  }

  LogBuffer log_;
  std::vector<json> handed_on_;
  std::string printed_;
};

TEST_F(Listening, ASecondSenderIsNotHandedOn) {
  for (int k = 0; k < 200; ++k) {
    send(k, 5000 * k, 1);
    send(50'000 + k, 5000 * k, 500);
  }
  listen();
  EXPECT_GT(handed_on_.size(), 50u);
  EXPECT_LE(handed_on_.size(), 200u);
  for (const json& j : handed_on_) EXPECT_EQ(j["ekf"]["tau_ext_hat"][0], 1) << j["timestamp"];
}

TEST_F(Listening, ForgedNumbersAndTimesAreNotHandedOn) {
  struct Forged {
    std::int64_t seq, utime;
  };
  constexpr std::int64_t kFar = std::int64_t{1} << 53, kYear = 31'557'600'000'000;
  const std::vector<Forged> forged = {{0, 0},        {3, kYear},     {1'000'000, 15'000},
                                      {kFar, kYear}, {kFar, 15'000}, {5, 0},
                                      {kFar + 1, 0}, {-1, kYear},    {1000, -1}};
  std::int64_t k = 10;
  for (const Forged& f : forged) {
    for (const std::int64_t end = k + 10; k < end; ++k) send(k, 5000 * k, 1);
    send(f.seq, f.utime, 500);
  }
  for (const std::int64_t end = k + 10; k < end; ++k) send(k, 5000 * k, 1);
  listen();
  EXPECT_GT(handed_on_.size(), 50u);
  double newest = 0;
  for (const json& j : handed_on_) {
    EXPECT_EQ(j["ekf"]["tau_ext_hat"][0], 1) << j["timestamp"];
    EXPECT_GT(j["timestamp"], newest);
    EXPECT_LT(j["timestamp"], 5e-3 * static_cast<double>(k));
    newest = j["timestamp"];
  }
}

TEST_F(Listening, OfFiveThousandNamesAHundredOfAKindAreHandedOnAndTheNextIsNamedOnce) {
  constexpr int kNames = 5000;
  for (int i = 0; i < kNames; ++i) {
    const std::string name = fmt::format("x{}", i);
    send("TAUEXT_ESTIMATE_" + name, estimate());
    detection_t d = detection();
    d.estimator = name;
    send("TAUEXT_DETECTION", d);
    d.estimator = std::string(60, 'y') + name;  // names that a terminal shows alike
    send("TAUEXT_DETECTION", d);
    force_t f = force();
    f.estimator = name;
    send("TAUEXT_FORCE", f);
  }
  listen();
  std::map<std::string, std::set<std::string>> names;  // by kind
  for (const json& j : handed_on_) {
    for (const auto& [name, value] : j.items())
      if (name != "timestamp") names[value.begin().key()].insert(name);
  }
  for (const char* kind : {"q", "detection", "force"}) {
    EXPECT_GT(names[kind].size(), 20u) << kind;
    EXPECT_LE(names[kind].size(), 100u) << kind;
  }
  const std::string named = ": rejected, as are all names beyond the first 100\n";
  EXPECT_NE(printed_.find(named), std::string::npos);
  EXPECT_EQ(printed_.find(named), printed_.rfind(named)) << "once";
  const auto too_many = fmt::format("{} of more names than are shown", 4 * kNames - 300);
  EXPECT_NE(printed_.find(too_many), std::string::npos)
      << printed_.substr(printed_.rfind("rejected"));
}

}  // namespace
}  // namespace tauext::live::test
