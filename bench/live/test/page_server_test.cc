// SPDX-License-Identifier: Apache-2.0
// What ci/selftest/live_shows asks a program, asked where sanitizers look on.
#include "bench/live/view/page_server.h"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <random>
#include <stdexcept>
#include <string>
#include <thread>

namespace tauext::live {
namespace {

// a connection to a page's server
class Client {
 public:
  explicit Client(const std::string& url) {
    sockaddr_in place{};
    place.sin_family = AF_INET;
    place.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    place.sin_port = htons(static_cast<std::uint16_t>(std::stoi(url.substr(url.rfind(':') + 1))));
    const timeval patience{20, 0};
    ::setsockopt(fd_, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
    EXPECT_EQ(::connect(fd_, reinterpret_cast<sockaddr*>(&place), sizeof place), 0);
  }
  ~Client() { ::close(fd_); }
  Client(const Client&) = delete;
  Client& operator=(const Client&) = delete;

  void say(const std::string& text) const {
    (void)::send(fd_, text.data(), text.size(), MSG_NOSIGNAL);
  }
  // all that comes until it has that many bytes, or the connection ends
  std::string hear(std::size_t enough = 1 << 20) const {
    std::string all;
    std::array<char, 4096> part{};
    while (all.size() < enough) {
      const auto n = ::recv(fd_, part.data(), part.size(), 0);
      if (n <= 0) break;
      all.append(part.data(), static_cast<std::size_t>(n));
    }
    return all;
  }
  void half_close() const { ::shutdown(fd_, SHUT_WR); }

 private:
  int fd_ = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
};

std::string get(const std::string& target, const std::string& host, const std::string& more = "") {
  return fmt::format("GET {} HTTP/1.1\r\nHost: {}\r\n{}\r\n", target, host, more);
}
std::string upgrade(const std::string& origin) {
  return fmt::format(
      "Origin: {}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Version: "
      "13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n",
      origin);
}

class Pages : public testing::Test {
 protected:
  std::string answer(const std::string& request) const {
    const Client c(server_.url());
    c.say(request);
    c.half_close();
    return c.hear();
  }
  PageServer server_{0, "wallmobot3/step"};
  std::string host_ = server_.url().substr(7);  // behind http://
  std::array<std::byte, 5> message_{std::byte{1}, std::byte{2}, std::byte{3}, std::byte{4},
                                    std::byte{5}};
};

TEST_F(Pages, AreServedToTheirOwnAddressAlone) {
  EXPECT_EQ(answer(get("/", host_)).find("HTTP/1.1 200 OK"), 0u);
  const std::string stream = answer(get("/stream.json", host_));
  EXPECT_NE(stream.find("estimate_t"), std::string::npos);
  EXPECT_NE(stream.find("\"title\":\"wallmobot3/step\""), std::string::npos) << stream;
  EXPECT_EQ(answer(get("/", "evil.example")).find("HTTP/1.1 403"), 0u);
  EXPECT_EQ(answer(get("/", host_, "Host: evil.example\r\n")).find("HTTP/1.1 403"), 0u) << "two";
  EXPECT_EQ(answer(get("/stream", host_, upgrade("http://evil.example"))).find("HTTP/1.1 403"), 0u);
  EXPECT_EQ(answer("POST / HTTP/1.1\r\nHost: " + host_ + "\r\n\r\n").find("HTTP/1.1 405"), 0u);
  EXPECT_THROW(PageServer(std::stoi(host_.substr(host_.find(':') + 1)), ""), std::runtime_error);
}

TEST_F(Pages, GetEachMessageInOrderAsItIs) {
  const Client c(server_.url());
  c.say(get("/stream", host_, upgrade(server_.url())));
  EXPECT_EQ(c.hear(1).find("HTTP/1.1 101"), 0u);
  std::thread sender([&] {
    while (!server_.is_watched()) std::this_thread::yield();
    for (int k = 0; k < 3; ++k) {
      std::this_thread::sleep_for(std::chrono::milliseconds(50));  // a frame each
      server_.put("AB", message_);
    }
  });
  const std::string wanted("\x82\x0d\x02\0\x05\0\0\0AB\x01\x02\x03\x04\x05", 15);  // RFC 6455
  EXPECT_EQ(c.hear(3 * wanted.size()), wanted + wanted + wanted);
  sender.join();
}

TEST_F(Pages, NothingThatIsSentHarmsIt) {
  std::mt19937 random(1);
  const std::string good = get("/stream", host_, upgrade(server_.url()));
  for (int k = 0; k < 300; ++k) {
    std::string bad = good;
    for (int i = 0; i < 1 + k % 4; ++i) bad[random() % bad.size()] = static_cast<char>(random());
    bad.resize(random() % 2 ? bad.size() : random() % bad.size());
    const Client c(server_.url());
    c.say(bad + std::string(random() % 3 * 10'000, 'x'));
    server_.put("AB", message_);
  }
  EXPECT_EQ(answer(get("/", host_)).find("HTTP/1.1 200 OK"), 0u);
}

}  // namespace
}  // namespace tauext::live
