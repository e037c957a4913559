// SPDX-License-Identifier: Apache-2.0
#include "lcmtypes/transport.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <stdexcept>

#ifdef TAUEXT_SANITIZED
// LCM 1.3.1 locks by GLib's g_static_rec_mutex_lock(), and frees none of what that allocates.
// Before GLib 2.76 that came from a pool, which LeakSanitizer does not look into.
extern "C" const char* __lsan_default_suppressions() {
  return "leak:libglib-2.0.so";
}
#endif

namespace tauext {

std::string trouble_with(const std::string& url) {
  if (scheme_of(url) != "udpm") return "";
  const GroupUrl to = group_url(url);
  const int fd = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  if (fd < 0) return fmt::format("no socket: {}", std::strerror(errno));
  // a datagram socket's connect() looks the route up
  const bool routed =
      ::connect(fd, reinterpret_cast<const sockaddr*>(&to.place), sizeof to.place) == 0;
  const int reason = errno;
  ::close(fd);
  if (routed) return "";
  return fmt::format(
      "no multicast route on this machine ({0}). Add one: sudo ip link set {1} up multicast on && "
      "sudo ip route add 224.0.0.0/4 dev {1}; or write a log, --lcm 'file://PATH?mode=w', and open "
      "that",
      std::strerror(reason), to.ttl > 0 ? "INTERFACE" : "lo");
}

LcmHandle open_lcm(const std::string& url, std::string& why) {
  why = trouble_with(url);
  LcmHandle lcm(why.empty() ? lcm_create(url.c_str()) : nullptr, lcm_destroy);
  if (why.empty() && !lcm) why = fmt::format("LCM cannot open {}", url);
  return lcm;
}

namespace {

[[noreturn]] void cannot_open(const std::string& path) {
  throw std::runtime_error(fmt::format("{}: cannot open for writing: {}{}", path,
                                       std::strerror(errno),
                                       errno == ELOOP ? "; name the file that it points to" : ""));
}

// A log grows in place, so a link that somebody planted would cost what it points to.
LogHandle new_log(const std::string& path) {
  struct stat there {};
  const bool device = ::stat(path.c_str(), &there) == 0 && !S_ISREG(there.st_mode);
  const int how = device ? O_WRONLY : O_WRONLY | O_CREAT | O_TRUNC | O_NOFOLLOW;
  const int fd = ::open(path.c_str(), how | O_CLOEXEC, 0666);
  if (fd < 0) cannot_open(path);
  if (device && (::fstat(fd, &there) != 0 || S_ISREG(there.st_mode))) {
    ::close(fd);
    errno = ELOOP;
    cannot_open(path);
  }
  LogHandle log(lcm_eventlog_create(fmt::format("/proc/self/fd/{}", fd).c_str(), "w"),
                lcm_eventlog_destroy);
  if (!log) cannot_open(path);
  ::close(fd);
  return log;
}

}  // namespace

Transport::Transport(const std::string& url)
    : url_(lcm_url(url)), lcm_(nullptr, lcm_destroy), log_(nullptr, lcm_eventlog_destroy) {
  if (scheme_of(url_) != "file") {
    lcm_ = open_lcm(url_, trouble_);
    return;
  }
  if (!url_.ends_with("?mode=w") || url_.find('?') != url_.rfind('?')) {
    throw std::invalid_argument(fmt::format("{}: to write a log add ?mode=w", url_));
  }
  log_ = new_log(log_of(url_));
}

bool Transport::publish(const char* channel, Bytes message) noexcept {
  if (log_) {
    lcm_eventlog_event_t event{};
    event.timestamp = std::chrono::duration_cast<std::chrono::microseconds>(
                          std::chrono::system_clock::now().time_since_epoch())
                          .count();
    event.channellen = static_cast<std::int32_t>(std::strlen(channel));
    event.datalen = static_cast<std::int32_t>(message.size());
    event.channel = const_cast<char*>(channel);
    event.data = const_cast<std::byte*>(message.data());
    return lcm_eventlog_write_event(log_.get(), &event) == 0 && std::fflush(log_->f) == 0;
  }
  return lcm_ && lcm_publish(lcm_.get(), channel, message.data(),
                             static_cast<unsigned>(message.size())) >= 0;
}

}  // namespace tauext
