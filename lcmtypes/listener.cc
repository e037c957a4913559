// SPDX-License-Identifier: Apache-2.0
#include "lcmtypes/listener.h"

#include <fmt/format.h>
#include <poll.h>

#include <stdexcept>
#include <utility>

namespace tauext {
namespace {

// the kernel's buffer is what keeps a burst while we are busy
std::string with_large_buffer(const std::string& url) {
  if (!url.starts_with("udpm://") || url.find("recv_buf_size") != std::string::npos) return url;
  return url + (url.find('?') == std::string::npos ? "?" : "&") + "recv_buf_size=2097152";
}

}  // namespace

Listener::Listener(const std::string& url, const std::string& channels, Handler handler)
    : url_(lcm_url(url)), own_(nullptr, lcm_destroy), lcm_(nullptr), handler_(std::move(handler)) {
  std::string why;
  own_ = open_lcm(with_large_buffer(url_), why);
  if (!own_) throw std::runtime_error(fmt::format("{}: {}", url_, why));
  lcm_ = own_.get();
  require_connection();
  subscribe(channels);
}

Listener::Listener(lcm_t* lcm, const std::string& channels, Handler handler)
    : own_(nullptr, lcm_destroy), lcm_(lcm), handler_(std::move(handler)) {
  subscribe(channels);
}

Listener::~Listener() {
  if (subscription_ != nullptr) lcm_unsubscribe(lcm_, subscription_);
}

void Listener::subscribe(const std::string& channels) {
  const auto forward = [](const lcm_recv_buf_t* buffer, const char* channel, void* self) {
    static_cast<Listener*>(self)->handler_(
        channel, buffer->recv_utime,
        {static_cast<const std::byte*>(buffer->data), buffer->data_size});
  };
  subscription_ = lcm_subscribe(lcm_, channels.c_str(), forward, this);
  if (subscription_ == nullptr) {
    throw std::runtime_error(fmt::format("{}: cannot subscribe to '{}'", url_, channels));
  }
  lcm_subscription_set_queue_capacity(subscription_, 0);  // no limit: the default drops at 30
}

std::string Listener::expression(const std::string& channel) {
  std::string out;
  for (const char c : channel) {
    if (std::string_view("\\^$.|?*+()[]{}").find(c) != std::string_view::npos) out += '\\';
    out += c;
  }
  return out;
}

bool Listener::wait(int milliseconds) {
  require_connection();
  pollfd ready{lcm_get_fileno(lcm_), POLLIN, 0};
  if (::poll(&ready, 1, milliseconds) <= 0) return false;  // or a signal came
  if (lcm_handle(lcm_) != 0)
    throw std::runtime_error(fmt::format("{}: the connection is gone", url_));
  return true;
}

// LCM hands a closed tcpq:// to select(), which aborts
void Listener::require_connection() const {
  if (lcm_get_fileno(lcm_) >= 0) return;
  throw std::runtime_error(fmt::format("{}: no connection; is a server there?", url_));
}

}  // namespace tauext
