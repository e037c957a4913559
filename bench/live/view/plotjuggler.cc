// SPDX-License-Identifier: Apache-2.0
#include "bench/live/view/plotjuggler.h"

#include <fmt/format.h>
#include <netdb.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <vector>

#include "lcmtypes/emitter.h"
#include "mjcf/trace/text.h"

namespace tauext::live {
namespace {

using Json = nlohmann::ordered_json;

template <class T>
std::vector<double> first(const T& values, int n) {
  return {values, values + n};
}

// the message, if it is one of these
template <class Message>
bool is(Bytes bytes, Message& m) {
  return hash_of(bytes) == Message::getHash() && decode(bytes, m) == Reject::kNone;
}

}  // namespace

std::string json_of(std::string_view channel, Bytes message) {
  Json j;
  const auto put = [&j](double t, const std::string& who, Json what) {
    j["timestamp"] = t;
    j[who] = std::move(what);
  };
  if (estimate_t e{}; is(message, e)) {
    Json of = {{"q", first(e.q, e.n)},
               {"qd", first(e.qd, e.n)},
               {"tau", first(e.tau, e.n)},
               {"tau_ext_hat", first(e.tau_ext_hat, e.n)},
               {"tau_ext_hat_min", first(e.tau_ext_hat_min, e.n)},
               {"tau_ext_hat_max", first(e.tau_ext_hat_max, e.n)}};
    if (e.reference != estimate_t::kNone) of["tau_ext_true"] = first(e.tau_ext_true, e.n);
    of["status"] = e.status;
    of["step_us"] = e.step_us;
    put(e.t,
        std::string(channel.substr(
            channel.starts_with(kEstimateChannel) ? std::strlen(kEstimateChannel) : 0)),
        std::move(of));
  } else if (detection_t d{}; is(message, d)) {
    put(static_cast<double>(d.utime) / 1e6, d.estimator,
        {{"detection",
          {{d.detector, {{"score", d.score}, {"mark", d.mark}, {"contact", d.contact}}}}}});
  } else if (force_t f{}; is(message, f)) {
    put(f.t, f.estimator,
        {{"force",
          {{"force", f.force},
           {"moment", f.moment},
           {"force_max", f.force_max},
           {"link", f.link}}}});
  } else if (sample_t s{}; is(message, s)) {
    put(s.t, std::string(channel),
        {{"q", first(s.q, s.n)}, {"qd", first(s.qd, s.n)}, {"tau", first(s.tau, s.n)}});
  }
  return j.empty() ? "" : j.dump(-1, ' ', false, Json::error_handler_t::replace);
}

PlotJuggler::PlotJuggler(const std::string& to) : to_(to) {
  const std::size_t colon = to.rfind(':');
  const int port = colon == to.npos ? 0 : number_in<int>(to.substr(colon + 1)).value_or(0);
  if (colon == 0 || port < 1 || port > 65535)
    throw std::invalid_argument(fmt::format("--plotjuggler {}: HOST:PORT, like {}", to, kUsual));
  addrinfo hints{}, *found = nullptr;
  hints.ai_socktype = SOCK_DGRAM;
  hints.ai_flags = AI_NUMERICSERV;
  const int e =
      ::getaddrinfo(to.substr(0, colon).c_str(), to.substr(colon + 1).c_str(), &hints, &found);
  if (e != 0) throw std::runtime_error(fmt::format("--plotjuggler {}: {}", to, ::gai_strerror(e)));
  socket_ = ::socket(found->ai_family, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  const bool good = socket_ >= 0 && ::connect(socket_, found->ai_addr, found->ai_addrlen) == 0;
  const int why = errno;
  ::freeaddrinfo(found);
  if (!good) throw std::runtime_error(fmt::format("--plotjuggler {}: {}", to, std::strerror(why)));
}

PlotJuggler::~PlotJuggler() {
  if (socket_ >= 0) ::close(socket_);
}

void PlotJuggler::send(std::string_view channel, Bytes message) noexcept {
  try {
    const std::string json = json_of(channel, message);
    if (!json.empty()) (void)::send(socket_, json.data(), json.size(), MSG_NOSIGNAL);
  } catch (const std::exception&) {  // no memory: lost
  }
}

}  // namespace tauext::live
