// SPDX-License-Identifier: Apache-2.0
#include "bench/live/view/page_server.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <chrono>
#include <map>
#include <mutex>
#include <nlohmann/json.hpp>
#include <set>
#include <stdexcept>
#include <thread>
#include <utility>

#include "bench/live/view/page_client.h"
#include "bench/report/assets.h"
#include "mjcf/trace/byte_order.h"

namespace tauext::live {
namespace {

using Answer = http::response<http::string_body>;
using namespace std::chrono_literals;

// one request, which may become a viewer
struct Visit {
  explicit Visit(asio::ip::tcp::socket s) : socket(std::move(s)) {
    parser.header_limit(8192);
    socket.expires_after(10s);
  }
  beast::tcp_stream socket;
  beast::flat_buffer buffer{16384};
  http::request_parser<http::empty_body> parser;
  Answer answer;
};

// what the page is headed with, and decodes messages by
std::string stream_json(const std::string& title) {
  nlohmann::json all = {{"title", title}};
  const auto add = [&types = all["types"]](const char* name, std::int64_t hash) {
    types[name] = {{"hash", fmt::format("{:016x}", static_cast<std::uint64_t>(hash))},
                   {"text", report::assets().at(std::string(name) + ".lcm")}};
  };
  add("estimate_t", estimate_t::getHash());
  add("detection_t", detection_t::getHash());
  add("force_t", force_t::getHash());
  add("sample_t", sample_t::getHash());
  add("summary_t", summary_t::getHash());
  return all.dump();
}

struct File {
  std::string type, text;
};
std::map<std::string, File, std::less<>> files(const std::string& title) {
  const auto& page = report::assets();
  std::map<std::string, File, std::less<>> all;
  all["/"] = {"text/html", page.at("live.html")};
  for (const char* name : {"common.js", "live.js", "uplot/uPlot.iife.min.js"})
    all[std::string("/") + name] = {"text/javascript", page.at(name)};
  for (const char* name : {"common.css", "uplot/uPlot.min.css"})
    all[std::string("/") + name] = {"text/css", page.at(name)};
  all["/stream.json"] = {"application/json", stream_json(title)};
  return all;
}

}  // namespace

class PageServer::Server {
 public:
  Server(int port, const std::string& title)
      : acceptor_(listening(port)), port_(acceptor_.local_endpoint().port()), files_(files(title)) {
    for (const char* name : {"127.0.0.1", "localhost"}) {
      hosts_.insert(fmt::format("{}:{}", name, port_));
      if (port_ == 80) hosts_.insert(name);  // as a browser says it
    }
    url_ = fmt::format("http://127.0.0.1:{}", port_);
    accept();
    timer_.expires_after(0us);
    tick();
    thread_ = std::thread([this] { context_.run(); });
  }
  ~Server() {
    asio::post(context_, [this] { finish(); });
    thread_.join();
  }

  const std::string& url() const { return url_; }
  bool is_watched() const { return watched_; }
  void put(std::string_view channel, Bytes message) {
    const std::lock_guard lock(mutex_);
    if (pending_.size() > kMostWaiting) return;  // nobody could take it
    pending_ += to_bytes(channel.size(), 2);
    pending_ += to_bytes(message.size(), 4);
    pending_.append(channel);
    pending_.append(reinterpret_cast<const char*>(message.data()), message.size());
  }

 private:
  asio::ip::tcp::acceptor listening(int port) {
    try {
      const auto number = static_cast<unsigned short>(port);
      return {context_, {asio::ip::address_v4::loopback(), number}};
    } catch (const boost::system::system_error& e) {
      throw std::runtime_error(
          fmt::format("--page {}: 127.0.0.1:{}: {}; 0 takes a port that is free", port, port,
                      e.code().message()));
    }
  }

  void accept() {
    acceptor_.async_accept([this](error_code e, asio::ip::tcp::socket socket) {
      if (!acceptor_.is_open()) return;
      if (!e && visits_ < kMostVisits) read(std::make_shared<Visit>(std::move(socket)));
      accept();
    });
  }

  void read(const std::shared_ptr<Visit>& v) {
    ++visits_;
    http::async_read_header(v->socket, v->buffer, v->parser, [this, v](error_code e, std::size_t) {
      const bool of_http =
          !e || (e.category() == make_error_code(http::error::bad_method).category() &&
                 e != http::error::end_of_stream);
      v->answer = e == http::error::header_limit || e == http::error::buffer_overflow
                      ? refusal(http::status::request_header_fields_too_large, "shorter requests")
                  : e ? refusal(http::status::bad_request, "requests of HTTP")
                      : answer(v->parser.get());
      if (v->answer.result() == http::status::switching_protocols) {
        open(std::move(v->socket), v->parser.get());
      } else if (of_http) {
        return write(v);
      }
      --visits_;
    });
  }
  void write(const std::shared_ptr<Visit>& v) {
    v->answer.prepare_payload();
    http::async_write(v->socket, v->answer, [this, v](error_code, std::size_t) {
      error_code ignored;
      v->socket.socket().shutdown(asio::ip::tcp::socket::shutdown_send, ignored);
      --visits_;
    });
  }

  static Answer refusal(http::status status, const std::string& wanted) {
    Answer a(status, 11);
    a.keep_alive(false);
    a.body() = fmt::format("tauext-live takes {}\n", wanted);
    return a;
  }
  // the one value of a field
  static std::string_view only(const Request& r, http::field f) {
    return r.count(f) == 1 ? std::string_view(r[f].data(), r[f].size()) : std::string_view();
  }

  Answer answer(const Request& r) const {
    if (hosts_.count(only(r, http::field::host)) == 0)
      return refusal(http::status::forbidden, "requests to " + url_);
    if (r.method() != http::verb::get)
      return refusal(http::status::method_not_allowed, "GET alone");
    if (r.target() == "/stream") {
      const std::string_view origin = only(r, http::field::origin);
      if (!origin.starts_with("http://") || hosts_.count(origin.substr(7)) == 0)
        return refusal(http::status::forbidden, "pages of " + url_);
      if (!beast::websocket::is_upgrade(r))
        return refusal(http::status::upgrade_required, "a WebSocket there");
      if (viewers_.size() >= kMostPages)
        return refusal(http::status::service_unavailable, fmt::format("{} pages", kMostPages));
      return Answer(http::status::switching_protocols, 11);
    }
    const auto file = files_.find(std::string_view(r.target().data(), r.target().size()));
    if (file == files_.end())
      return refusal(http::status::not_found, "no other address than " + url_);
    Answer a(http::status::ok, 11);
    a.keep_alive(false);
    a.set(http::field::content_type, file->second.type + "; charset=utf-8");
    a.set(http::field::cache_control, "no-store");
    a.set("X-Content-Type-Options", "nosniff");
    a.set("Content-Security-Policy",
          "default-src 'none'; script-src 'self'; style-src 'self' 'unsafe-inline'; "
          "connect-src 'self'; img-src data:; base-uri 'none'; frame-ancestors 'none'");
    a.body() = file->second.text;
    return a;
  }

  void open(beast::tcp_stream socket, const Request& request) {
    socket.expires_never();
    const auto viewer = std::make_shared<Viewer>(std::move(socket), kMostWaiting,
                                                 [this](const std::shared_ptr<Viewer>& v) {
                                                   viewers_.erase(v);
                                                   if (finishing_ && viewers_.empty())
                                                     context_.stop();
                                                 });
    viewers_.insert(viewer);
    viewer->accept(request, [this] { watched_ = true; });
  }

  void tick() {
    timer_.expires_at(
        std::max(timer_.expiry() + 1000000us / kFrames, std::chrono::steady_clock::now()));
    timer_.async_wait([this](error_code e) {
      if (e) return;
      send();
      tick();
    });
  }
  void send() {
    std::string taken;
    {
      const std::lock_guard lock(mutex_);
      taken.swap(pending_);
    }
    if (taken.empty()) return;
    const auto frame = std::make_shared<const std::string>(std::move(taken));
    const auto all = viewers_;  // of which one may go
    for (const auto& v : all) v->send(frame);
  }
  void finish() {  // a page that is busy gets the end, too; one that takes nothing is left
    acceptor_.close();
    send();
    finishing_ = true;
    for (const auto& v : std::set(viewers_)) v->finish();
    timer_.expires_after(viewers_.empty() ? 0s : 3s);  // which ends tick()
    timer_.async_wait([this](error_code) { context_.stop(); });
  }

  static constexpr int kMostVisits = 64;

  asio::io_context context_;
  asio::ip::tcp::acceptor acceptor_;
  asio::steady_timer timer_{context_};
  int port_;
  std::set<std::string, std::less<>> hosts_;
  std::string url_;
  const std::map<std::string, File, std::less<>> files_;
  std::set<std::shared_ptr<Viewer>> viewers_;
  int visits_ = 0;
  std::atomic<bool> watched_ = false;
  bool finishing_ = false;
  std::mutex mutex_;
  std::string pending_;  // messages since the last frame
  std::thread thread_;   // last: it uses the others
};

PageServer::PageServer(int port, const std::string& title)
    : server_(std::make_unique<Server>(port, title)) {}
PageServer::~PageServer() = default;
const std::string& PageServer::url() const {
  return server_->url();
}
bool PageServer::is_watched() const {
  return server_->is_watched();
}
void PageServer::put(std::string_view channel, Bytes message) {
  server_->put(channel, message);
}

}  // namespace tauext::live
