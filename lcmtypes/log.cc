// SPDX-License-Identifier: Apache-2.0
#include "lcmtypes/log.h"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <iterator>
#include <memory>
#include <stdexcept>
#include <vector>

namespace tauext {
namespace {

constexpr std::uint32_t kSync = 0xEDA1DA01;
constexpr std::size_t kHeader = 28;                  // sync, number (8), time (8), two lengths
constexpr std::uint32_t kLongestMessage = 1u << 26;  // [bytes] 64 MiB; ours have some hundred

using File = std::unique_ptr<std::FILE, decltype(&std::fclose)>;

template <int Bytes>
std::uint64_t big_endian(const unsigned char* p) {
  std::uint64_t value = 0;
  for (int i = 0; i < Bytes; ++i) value = value << 8 | p[i];
  return value;
}

template <int Bytes>
void put_big_endian(std::uint64_t value, std::string& to) {
  for (int i = Bytes - 1; i >= 0; --i) to += static_cast<char>(value >> 8 * i & 0xFF);
}

// LCM's own reader stops at junk and believes lengths
class Reader {
 public:
  explicit Reader(const std::string& path)
      : path_(path), file_(std::fopen(path.c_str(), "rbe"), std::fclose) {
    if (!file_) fail("cannot read");
    if (std::fseek(file_.get(), 0, SEEK_END) != 0) fail("cannot read");
    left_ = std::ftell(file_.get());
    std::rewind(file_.get());
  }

  LogFaults run(const std::function<void(const LogEvent&)>& handler) {
    std::int64_t events = 0;
    bool in_junk = false;
    while (fill(kHeader)) {
      const Length length = next_event();
      if (length > 0) {
        handler(event());
        ++events;
        begin_ += length;
      } else {
        ++faults_.junk_bytes;
        faults_.junk_stretches += !in_junk;
        ++begin_;
      }
      in_junk = length == 0;
      if (!in_junk) faults_.truncated = false;  // what did not fit was junk, not the end
    }
    if (end_ > begin_) {  // less than a header
      if (in_junk) faults_.junk_bytes += static_cast<std::int64_t>(end_ - begin_);
      faults_.truncated = faults_.truncated || !in_junk;
    }
    if (std::ferror(file_.get()) != 0) fail("cannot read");
    if (events == 0) {
      throw std::runtime_error(fmt::format("{}: no LCM log: there is no event in it", path_));
    }
    return faults_;
  }

 private:
  using Length = std::size_t;

  // at least so many bytes behind begin_; false where the file has less
  bool fill(Length wanted) {
    if (end_ - begin_ < wanted && left_ > 0) {
      const auto left = static_cast<Length>(left_);
      read_more(std::min(left, std::max<Length>(wanted - (end_ - begin_), 1 << 16)));
    }
    return end_ - begin_ >= wanted;
  }

  void read_more(Length bytes) {
    buffer_.erase(buffer_.begin(), buffer_.begin() + static_cast<std::ptrdiff_t>(begin_));
    end_ -= begin_;
    begin_ = 0;
    buffer_.resize(end_ + bytes);
    const Length got = std::fread(buffer_.data() + end_, 1, bytes, file_.get());
    end_ += got;
    left_ = got < bytes ? 0 : left_ - static_cast<std::int64_t>(got);
    buffer_.resize(end_);
  }

  // size of the good event that begins here; 0 if none does
  Length next_event() {
    const unsigned char* p = buffer_.data() + begin_;
    if (big_endian<4>(p) != kSync) return 0;
    const auto channel = static_cast<std::uint32_t>(big_endian<4>(p + 20));
    const auto message = static_cast<std::uint32_t>(big_endian<4>(p + 24));
    if (channel == 0 || channel > kLongestChannel || message > kLongestMessage) return 0;
    const Length length = kHeader + channel + message;
    // before anything is read: a forged length would have the rest of the file in memory, again and
    // again
    if (length > end_ - begin_ + static_cast<Length>(left_)) {
      faults_.truncated = true;
      return 0;
    }
    fill(length);
    return believable(length) ? length : 0;
  }

  // a forged length swallows what follows: then the next event begins inside, and none behind
  bool believable(Length length) {
    fill(length + 4);
    const unsigned char* const p = buffer_.data() + begin_;
    const bool last = end_ - begin_ < length + 4;
    if (last || big_endian<4>(p + length) == kSync) return true;
    constexpr unsigned char kHead[] = {0xED, 0xA1, 0xDA, 0x01};
    return std::search(p + kHeader, p + length, std::begin(kHead), std::end(kHead)) == p + length;
  }

  LogEvent event() const {
    const unsigned char* const p = buffer_.data() + begin_;
    const auto channel = big_endian<4>(p + 20), message = big_endian<4>(p + 24);
    return {static_cast<std::int64_t>(big_endian<8>(p + 12)),
            {reinterpret_cast<const char*>(p + kHeader), channel},
            {reinterpret_cast<const std::byte*>(p + kHeader + channel), message}};
  }

  [[noreturn]] void fail(const char* what) const {
    throw std::runtime_error(fmt::format("{}: {}: {}", path_, what, std::strerror(errno)));
  }

  std::string path_;
  File file_;
  std::int64_t left_ = 0;  // bytes not yet read
  std::vector<unsigned char> buffer_;
  Length begin_ = 0, end_ = 0;
  LogFaults faults_;
};

}  // namespace

void LogBuffer::append(std::string_view channel, std::int64_t utime, Bytes message) {
  put_big_endian<4>(kSync, bytes_);
  put_big_endian<8>(events_++, bytes_);
  put_big_endian<8>(static_cast<std::uint64_t>(utime), bytes_);
  put_big_endian<4>(channel.size(), bytes_);
  put_big_endian<4>(message.size(), bytes_);
  bytes_ += channel;
  for (const std::byte b : message) bytes_ += static_cast<char>(b);
}

LogFaults read_log(const std::string& path, const std::function<void(const LogEvent&)>& handler) {
  return Reader(path).run(handler);
}

}  // namespace tauext
