// SPDX-License-Identifier: Apache-2.0
#include "lcmtypes/listener.h"

#include <fmt/format.h>
#include <poll.h>

#include <algorithm>
#include <stdexcept>
#include <utility>

namespace tauext {
namespace {

// the regular expression that means a channel alone, or all that begin so
std::string expression(std::string_view channel) {
  std::string out;
  const bool open = channel.ends_with('*');
  if (open) channel.remove_suffix(1);
  for (const char c : channel) {
    if (std::string_view("\\^$.|?*+()[]{}").find(c) != std::string_view::npos) out += '\\';
    out += c;
  }
  return open ? out + ".*" : out;
}

}  // namespace

Listener::Listener(const std::string& url, std::vector<std::string> channels, Handler handler)
    : url_(lcm_url(url)),
      channels_(std::move(channels)),
      handler_(std::move(handler)),
      own_(nullptr, lcm_destroy) {
  std::string why;
  if (scheme_of(url_) == "udpm") {
    why = trouble_with(url_);
    if (why.empty()) group_.emplace(group_url(url_));
  } else {
    own_ = open_lcm(url_, why);
  }
  if (!why.empty()) throw std::runtime_error(fmt::format("{}: {}", url_, why));
  lcm_ = own_.get();
  if (group_) return;
  require_connection();
  subscribe();
}

Listener::Listener(lcm_t* lcm, std::vector<std::string> channels, Handler handler)
    : channels_(std::move(channels)),
      handler_(std::move(handler)),
      own_(nullptr, lcm_destroy),
      lcm_(lcm) {
  subscribe();
}

Listener::~Listener() {
  for (lcm_subscription_t* s : subscriptions_) lcm_unsubscribe(lcm_, s);
}

void Listener::subscribe() {
  const auto forward = [](const lcm_recv_buf_t* buffer, const char* channel, void* self) {
    static_cast<Listener*>(self)->handler_(
        channel, 0, {static_cast<const std::byte*>(buffer->data), buffer->data_size});
  };
  for (const std::string& channel : channels_) {
    lcm_subscription_t* const s = lcm_subscribe(lcm_, expression(channel).c_str(), forward, this);
    if (s == nullptr) {
      throw std::runtime_error(fmt::format("{}: cannot subscribe to '{}'", url_, channel));
    }
    // no limit: the default drops at 30. Without multicast, what waits is in the socket or the log
    lcm_subscription_set_queue_capacity(s, 0);
    subscriptions_.push_back(s);
  }
}

bool Listener::wants(std::string_view channel) const {
  return std::any_of(channels_.begin(), channels_.end(), [&](std::string_view wanted) {
    if (!wanted.ends_with('*')) return channel == wanted;
    wanted.remove_suffix(1);
    return channel.starts_with(wanted);
  });
}

bool Listener::wait(int milliseconds) {
  if (!group_) require_connection();
  pollfd ready{group_ ? group_->descriptor() : lcm_get_fileno(lcm_), POLLIN, 0};
  if (::poll(&ready, 1, milliseconds) <= 0) return false;  // or a signal came
  if (group_) return take_from_group();
  if (lcm_handle(lcm_) != 0)
    throw std::runtime_error(fmt::format("{}: the connection is gone", url_));
  return true;
}

// what is there, but not for ever: who waits has other things to do
bool Listener::take_from_group() {
  constexpr int kAtOnce = 1000;
  Datagram d;
  Sender sender = 0;
  bool any = false;
  for (int i = 0; i < kAtOnce && group_->take(d, sender); ++i) {
    if (d.channel.empty()) continue;  // it was refused
    if (!wants(d.channel)) {
      ++unwanted_;
      continue;
    }
    any = true;
    handler_(d.channel, sender, d.message);
  }
  return any;
}

GroupSocket::Counts Listener::refused() const {
  GroupSocket::Counts counts = group_ ? group_->counts() : GroupSocket::Counts{};
  counts.unwanted = unwanted_;
  return counts;
}

// LCM hands a closed tcpq:// to select(), which aborts
void Listener::require_connection() const {
  if (lcm_get_fileno(lcm_) >= 0) return;
  throw std::runtime_error(fmt::format("{}: no connection; is a server there?", url_));
}

}  // namespace tauext
