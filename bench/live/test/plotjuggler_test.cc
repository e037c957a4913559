// SPDX-License-Identifier: Apache-2.0
#include "bench/live/view/plotjuggler.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "lcmtypes/wire.h"

namespace tauext::live {
namespace {

using nlohmann::json;

template <class Message>
std::vector<std::byte> bytes_of(const Message& m) {
  std::vector<std::byte> bytes(m.getEncodedSize());
  EXPECT_EQ(encode(m, bytes), bytes.size());
  return bytes;
}

estimate_t an_estimate() {
  estimate_t e{};
  e.utime = 1'250'000, e.t = 1.25, e.n = 2, e.samples = 5, e.reference = estimate_t::kTruth;
  e.q[1] = 0.5, e.tau_ext_hat[0] = -3, e.tau_ext_hat_max[1] = 7.5, e.tau_ext_true[1] = 7;
  return e;
}

TEST(PlotJugglerJson, HasEachTypeUnderItsEstimator) {
  const json e = json::parse(json_of("TAUEXT_ESTIMATE_ekf", bytes_of(an_estimate())));
  EXPECT_EQ(e["timestamp"], 1.25);
  EXPECT_EQ(e["ekf"]["tau_ext_hat"], (std::vector<double>{-3, 0}));
  EXPECT_EQ(e["ekf"]["tau_ext_hat_max"], (std::vector<double>{0, 7.5}));
  EXPECT_EQ(e["ekf"]["tau_ext_true"], (std::vector<double>{0, 7}));
  EXPECT_EQ(e["ekf"]["q"], (std::vector<double>{0, 0.5}));

  detection_t d{};
  d.utime = 2'000'000, d.score = 1.5, d.mark = 1, d.contact = detection_t::kCollision;
  d.estimator = "ekf", d.detector = "cusum\xff";  // no UTF-8
  const json of_d = json::parse(json_of("TAUEXT_DETECTION", bytes_of(d)));
  EXPECT_EQ(of_d["timestamp"], 2);
  EXPECT_EQ(of_d["ekf"]["detection"].begin().value()["score"], 1.5);

  force_t f{};
  f.utime = 500'000, f.t = 0.5, f.force[2] = -9, f.link = 2, f.estimator = "mo2";
  EXPECT_EQ(json::parse(json_of("TAUEXT_FORCE", bytes_of(f)))["mo2"]["force"]["force"][2], -9);
}

TEST(PlotJugglerJson, IsNoneOfWhatIsNoMessage) {
  EXPECT_EQ(json_of("TAUEXT_ESTIMATE_ekf", {}), "");
  std::vector<std::byte> cut = bytes_of(an_estimate());
  cut.pop_back();
  EXPECT_EQ(json_of("TAUEXT_ESTIMATE_ekf", cut), "");
}

TEST(PlotJuggler, SendsADatagramForEachMessage) {
  const int fd = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  sockaddr_in place{};
  place.sin_family = AF_INET;
  place.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof place;
  ASSERT_EQ(::bind(fd, reinterpret_cast<sockaddr*>(&place), size), 0);
  ASSERT_EQ(::getsockname(fd, reinterpret_cast<sockaddr*>(&place), &size), 0);
  PlotJuggler to(fmt::format("127.0.0.1:{}", ntohs(place.sin_port)));
  to.send("TAUEXT_ESTIMATE_ekf", bytes_of(an_estimate()));
  to.send("TAUEXT_ESTIMATE_ekf", {});  // says nothing
  std::array<char, 4096> buffer{};
  const auto n = ::recv(fd, buffer.data(), buffer.size(), 0);
  ASSERT_GT(n, 0);
  EXPECT_EQ(json::parse(std::string(buffer.data(), static_cast<std::size_t>(n)))["ekf"]["status"],
            0);
  EXPECT_LT(::recv(fd, buffer.data(), buffer.size(), MSG_DONTWAIT), 0);
  ::close(fd);
}

TEST(PlotJuggler, RefusesWhatIsNoAddress) {
  for (const char* bad : {"", "here", ":1", "127.0.0.1:", "127.0.0.1:port", "127.0.0.1:0",
                          "127.0.0.1:99999", "127.0.0.1:98x"})
    EXPECT_THROW(PlotJuggler{bad}, std::invalid_argument) << bad;
}

}  // namespace
}  // namespace tauext::live
