// SPDX-License-Identifier: Apache-2.0
/// @file
/// One page that looks at the stream, as the page's server knows it.
#pragma once

#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#include <cstddef>
#include <deque>
#include <functional>
#include <memory>
#include <string>
#include <utility>

namespace tauext::live {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
using boost::system::error_code;

/// What is sent to all pages at once.
using Frame = std::shared_ptr<const std::string>;
/// What a browser asks with.
using Request = http::request<http::empty_body>;

/// A page that looks on. All of it in the thread of its socket.
class Viewer : public std::enable_shared_from_this<Viewer> {
 public:
  /// Is told when it has gone.
  using Ended = std::function<void(const std::shared_ptr<Viewer>&)>;

  /// @param most_waiting [bytes] it is closed when more of them wait for it
  Viewer(beast::tcp_stream socket, std::size_t most_waiting, Ended ended)
      : ws_(std::move(socket)), most_waiting_(most_waiting), ended_(std::move(ended)) {
    error_code ignored;  // or a frame's end waits for an acknowledgement
    beast::get_lowest_layer(ws_).socket().set_option(asio::ip::tcp::no_delay(true), ignored);
    ws_.binary(true);
    ws_.read_message_max(1);
    ws_.set_option(beast::websocket::stream_base::timeout::suggested(beast::role_type::server));
  }

  /// Answers its request, which asks for a WebSocket.
  /// @param opened is called once it gets all that is sent
  void accept(const Request& request, std::function<void()> opened) {
    ws_.async_accept(request, [self = shared_from_this(), opened](error_code e) {
      if (e) return self->close();
      self->open_ = true;
      opened();
      self->read();
    });
  }
  /// The next frame, once those before it are sent.
  void send(const Frame& frame) {
    if (!open_) return;
    waiting_ += frame->size();
    frames_.push_back(frame);
    if (waiting_ > most_waiting_) return close();
    if (frames_.size() == 1) write();
  }
  /// Closes it once all is sent.
  void finish() {
    finishing_ = true;
    if (frames_.empty()) say_goodbye();
  }

 private:
  void read() {  // a page has nothing to say but that it goes
    ws_.async_read(buffer_,
                   [self = shared_from_this()](error_code, std::size_t) { self->close(); });
  }
  void write() {
    ws_.async_write(asio::buffer(*frames_.front()),
                    [self = shared_from_this()](error_code e, std::size_t) { self->written(e); });
  }
  void written(error_code e) {
    if (e || !open_) return close();
    waiting_ -= frames_.front()->size();
    frames_.pop_front();
    if (!frames_.empty()) return write();
    if (finishing_) say_goodbye();
  }
  void say_goodbye() {
    if (open_)
      ws_.async_close(beast::websocket::close_code::normal,
                      [self = shared_from_this()](error_code) { self->close(); });
  }
  void close() {
    open_ = false;
    beast::get_lowest_layer(ws_).close();
    ended_(shared_from_this());
  }

  beast::websocket::stream<beast::tcp_stream> ws_;
  std::size_t most_waiting_;
  Ended ended_;
  beast::flat_buffer buffer_;
  std::deque<Frame> frames_;  // the first is being written
  std::size_t waiting_ = 0;   // [bytes] of them
  bool open_ = false, finishing_ = false;
};

}  // namespace tauext::live
