// SPDX-License-Identifier: Apache-2.0
#include "lcmtypes/log.h"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <iterator>
#include <stdexcept>
#include <utility>

#include "mjcf/trace/byte_order.h"

namespace tauext {
namespace {

constexpr std::uint32_t kSync = 0xEDA1DA01;
constexpr std::endian kBig = std::endian::big;
constexpr std::size_t kHeader = 28;                  // sync, number (8), time (8), two lengths
constexpr std::uint32_t kLongestMessage = 1u << 26;  // [bytes] 64 MiB; ours have some hundred

}  // namespace

// LCM's own reader stops at junk and believes lengths
LogEvents::LogEvents(const std::string& path)
    : path_(path), file_(std::fopen(path.c_str(), "rbe"), std::fclose) {
  if (!file_) fail("cannot read");
  if (std::fseek(file_.get(), 0, SEEK_END) != 0) fail("cannot read");
  left_ = std::ftell(file_.get());
  std::rewind(file_.get());
}

bool LogEvents::next(LogEvent& to) {
  begin_ += std::exchange(used_, 0);
  while (fill(kHeader)) {
    used_ = next_event();
    if (used_ > 0) {
      any_ = true;
      in_junk_ = faults_.truncated = false;  // what did not fit was junk, not the end
      to = event();
      return true;
    }
    ++faults_.junk_bytes;
    faults_.junk_stretches += !std::exchange(in_junk_, true);
    ++begin_;
  }
  if (end_ > begin_) {  // less than a header
    if (in_junk_) faults_.junk_bytes += static_cast<std::int64_t>(end_ - begin_);
    faults_.truncated = faults_.truncated || !in_junk_;
    begin_ = end_;
  }
  if (std::ferror(file_.get()) != 0) fail("cannot read");
  if (!any_)
    throw std::runtime_error(fmt::format("{}: no LCM log: there is no event in it", path_));
  return false;
}

// at least so many bytes behind begin_; false where the file has less
bool LogEvents::fill(std::size_t wanted) {
  if (end_ - begin_ < wanted && left_ > 0) {
    const auto left = static_cast<std::size_t>(left_);
    read_more(std::min(left, std::max<std::size_t>(wanted - (end_ - begin_), 1 << 16)));
  }
  return end_ - begin_ >= wanted;
}

void LogEvents::read_more(std::size_t bytes) {
  buffer_.erase(buffer_.begin(), buffer_.begin() + static_cast<std::ptrdiff_t>(begin_));
  end_ -= begin_;
  begin_ = 0;
  buffer_.resize(end_ + bytes);
  const std::size_t got = std::fread(buffer_.data() + end_, 1, bytes, file_.get());
  end_ += got;
  left_ = got < bytes ? 0 : left_ - static_cast<std::int64_t>(got);
  buffer_.resize(end_);
}

// size of the good event that begins here; 0 if none does
std::size_t LogEvents::next_event() {
  const unsigned char* p = buffer_.data() + begin_;
  if (from_bytes(p, 4, kBig) != kSync) return 0;
  const auto channel = from_bytes(p + 20, 4, kBig), message = from_bytes(p + 24, 4, kBig);
  if (channel == 0 || channel > kLongestChannel || message > kLongestMessage) return 0;
  const std::size_t length = kHeader + channel + message;
  // before anything is read: a forged length would have the rest of the file in memory, again and
  // again
  if (length > end_ - begin_ + static_cast<std::size_t>(left_)) {
    faults_.truncated = true;
    return 0;
  }
  fill(length);
  return believable(length) ? length : 0;
}

// a forged length swallows what follows: then the next event begins inside, and none behind
bool LogEvents::believable(std::size_t length) {
  fill(length + 4);
  const unsigned char* const p = buffer_.data() + begin_;
  const bool last = end_ - begin_ < length + 4;
  if (last || from_bytes(p + length, 4, kBig) == kSync) return true;
  constexpr unsigned char kHead[] = {0xED, 0xA1, 0xDA, 0x01};
  return std::search(p + kHeader, p + length, std::begin(kHead), std::end(kHead)) == p + length;
}

LogEvent LogEvents::event() const {
  const unsigned char* const p = buffer_.data() + begin_;
  const auto channel = from_bytes(p + 20, 4, kBig), message = from_bytes(p + 24, 4, kBig);
  return {static_cast<std::int64_t>(from_bytes(p + 12, 8, kBig)),
          {reinterpret_cast<const char*>(p + kHeader), channel},
          {reinterpret_cast<const std::byte*>(p + kHeader + channel), message}};
}

void LogEvents::fail(const char* what) const {
  throw std::runtime_error(fmt::format("{}: {}: {}", path_, what, std::strerror(errno)));
}

void LogBuffer::append(std::string_view channel, std::int64_t utime, Bytes message) {
  bytes_ += to_bytes(kSync, 4, kBig) + to_bytes(events_++, 8, kBig) +
            to_bytes(static_cast<std::uint64_t>(utime), 8, kBig) +
            to_bytes(channel.size(), 4, kBig) + to_bytes(message.size(), 4, kBig);
  bytes_ += channel;
  for (const std::byte b : message) bytes_ += static_cast<char>(b);
}

LogFaults read_log(const std::string& path, const std::function<void(const LogEvent&)>& handler) {
  LogEvents events(path);
  for (LogEvent e; events.next(e);) handler(e);
  return events.faults();
}

}  // namespace tauext
