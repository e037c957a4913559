// SPDX-License-Identifier: Apache-2.0
#include "mjcf/trace/read/bag/mcap_messages.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <utility>
#include <vector>

#include "mjcf/trace/byte_order.h"
#include "mjcf/trace/printable.h"
#include "mjcf/trace/read/text/unpacked_file.h"

namespace tauext {
namespace {

// kinds of records
namespace op {
constexpr std::uint8_t kFooter = 2, kSchema = 3, kChannel = 4, kMessage = 5, kChunk = 6, kEnd = 15;
}

constexpr std::uint64_t kMagicSize = 8, kHeadSize = 9, kFooterSize = 20;  // [bytes]
constexpr std::uint64_t kMostOfChunk = 256 << 20;                         // [bytes]

[[noreturn]] void fail_damaged(const ByteFile& file, std::string_view what) {
  file.fail(fmt::format("is damaged: {}; `mcap recover` makes a file of what is whole", what));
}

// the fields of a record in their order
class Fields {
 public:
  Fields(const ByteFile& file, std::string_view bytes) : file_(file), bytes_(bytes) {}

  std::uint64_t number(std::size_t size) { return from_bytes(take(size).data(), size); }
  std::string_view text() { return take(number(4)); }
  std::string_view rest() { return bytes_; }

 private:
  std::string_view take(std::uint64_t size) {
    if (size > bytes_.size()) fail_damaged(file_, "a record is shorter than its fields");
    const std::string_view some = bytes_.substr(0, size);
    bytes_.remove_prefix(size);
    return some;
  }

  const ByteFile& file_;
  std::string_view bytes_;
};

}  // namespace

McapMessages::McapMessages(const std::string& path) : file_(path) {
  read_summary();
  rewind();
  const auto lacks_schema = [&](const auto& c) {
    return c.second.schema != 0 && schemas_.count(c.second.schema) == 0;
  };
  // a file that was not closed has no summary, and who writes one may leave them out
  if (channels_.empty() || std::any_of(channels_.begin(), channels_.end(), lacks_schema))
    for (Record record; next_record(record);) learn(record);
  if (channels_.empty() && lost_) file_.fail(note());
  std::vector<BagTopic> topics;
  for (const auto& [id, c] : channels_)
    topics.push_back({c.topic, schemas_[c.schema].type, c.encoding});
  add_topics(topics);
}

void McapMessages::select() {
  wanted_.clear();
  for (const auto& [id, c] : channels_) {
    const Schema& s = schemas_[c.schema];
    if (!is_chosen({c.topic, s.type, c.encoding})) continue;
    wanted_.insert(id);
    set_definition(s.language, s.definition);
  }
  rewind();
}

void McapMessages::rewind() {
  at_ = kMagicSize, end_ = file_.size();
  ended_ = false, lost_.reset();
  any_chunk_ = false, damage_.clear();
  chunk_.clear(), chunk_at_ = 0;
}

std::string McapMessages::note() const {
  if (!lost_) return "";
  if (!damage_.empty())
    return fmt::format("the last {} of its {} bytes are not read: a chunk {}", *lost_, file_.size(),
                       damage_);
  return *lost_ == 0 ? "it was not closed, so its last messages may be missing"
                     : fmt::format(
                           "it ends too early: the last {} of its {} bytes are no whole "
                           "record, and are not read",
                           *lost_, file_.size());
}

// the channels that stand at the end of a file that was closed
void McapMessages::read_summary() {
  std::string tail(kHeadSize + kFooterSize + kMagicSize, '\0');
  if (file_.size() < kMagicSize + tail.size()) return;
  const std::uint64_t footer = file_.size() - tail.size();
  file_.read(footer, tail.data(), tail.size());
  if (tail[0] != op::kFooter || !tail.ends_with("\x89MCAP0\r\n")) return;
  const std::uint64_t begin = Fields(file_, std::string_view(tail).substr(kHeadSize)).number(8);
  if (begin < kMagicSize || begin >= footer) return;
  at_ = begin, end_ = footer;
  for (Record record; next_record(record);) learn(record);
}

void McapMessages::learn(const Record& record) {
  Fields f(file_, record.bytes);
  if (record.kind == op::kSchema) {
    const auto id = static_cast<std::uint16_t>(f.number(2));
    Schema& s = schemas_[id];
    s.type = f.text(), s.language = f.text();
    const std::string_view definition = f.text();
    s.definition = definition.size() <= kMost ? definition : "";
  } else if (record.kind == op::kChannel) {
    const auto id = static_cast<std::uint16_t>(f.number(2));
    Channel& c = channels_[id];
    c.schema = static_cast<std::uint16_t>(f.number(2));
    c.topic = f.text(), c.encoding = f.text();
  }
}

// @returns false
// @param closed whether the file says that it ends here
bool McapMessages::end(bool closed) {
  if (!ended_ && !closed) lost_ = file_.size() - at_;
  ended_ = true;
  return false;
}

// false at the end; of messages that are too long the size alone
bool McapMessages::next_record(Record& record) {
  while (!next_in_chunk(record)) {
    if (ended_ || at_ == end_) return end(end_ < file_.size());
    std::string head(kHeadSize, '\0');
    if (!file_.has(at_, kHeadSize)) return end(false);
    file_.read(at_, head.data(), head.size());
    Fields f(file_, head);
    record.kind = static_cast<std::uint8_t>(f.number(1));
    record.size = f.number(8);
    // a disk that lost its power leaves zeros, of which no record is made
    if (record.kind == 0 || !file_.has(at_ + kHeadSize, record.size)) return end(false);
    if (record.kind == op::kEnd || record.kind == op::kFooter) return end(true);
    at_ += kHeadSize;
    const std::uint64_t begin = std::exchange(at_, at_ + record.size);
    if (record.kind == op::kChunk) {
      if (!take_chunk(begin)) return end(false);
      continue;
    }
    const bool wanted =
        record.kind == op::kSchema || record.kind == op::kChannel || record.kind == op::kMessage;
    record_.resize(wanted && record.size <= kMostOfChunk ? record.size : 0);
    file_.read(begin, record_.data(), record_.size());
    record.bytes = record_;
    return true;
  }
  return true;
}

bool McapMessages::next_in_chunk(Record& record) {
  if (chunk_at_ == chunk_.size()) return false;
  Fields f(file_, std::string_view(chunk_).substr(chunk_at_));
  record.kind = static_cast<std::uint8_t>(f.number(1));
  record.size = f.number(8);
  if (record.size > f.rest().size()) fail_damaged(file_, "a record ends behind its chunk");
  record.bytes = f.rest().substr(0, record.size);
  chunk_at_ += kHeadSize + record.size;
  return true;
}

// false: it is damaged, and what was read before is all that is read
bool McapMessages::take_chunk(std::uint64_t begin) {
  try {
    open_chunk(begin);
    any_chunk_ = true;
    return true;
  } catch (const std::runtime_error& e) {
    if (!any_chunk_) throw;
    damage_ = e.what();
    if (const std::string path = file_.path() + ": "; damage_.starts_with(path))
      damage_.erase(0, path.size());
    chunk_.clear(), chunk_at_ = 0;
    at_ = begin - kHeadSize;
    return false;
  }
}

// whose record's bytes end at at_
void McapMessages::open_chunk(std::uint64_t begin) {
  if (at_ - begin > kMostOfChunk) file_.fail("has a chunk of more than 256 MB");
  record_.resize(at_ - begin);
  file_.read(begin, record_.data(), record_.size());
  Fields f(file_, record_);
  f.number(8), f.number(8);  // times
  const std::uint64_t size = f.number(8);
  const auto crc = static_cast<std::uint32_t>(f.number(4));
  const std::string compression(f.text());
  const std::uint64_t packed = f.number(8);
  if (size > kMostOfChunk) file_.fail("has a chunk of more than 256 MB");
  if (packed > f.rest().size()) fail_damaged(file_, "a chunk is shorter than it says");
  const std::string_view bytes = f.rest().substr(0, packed);
  if (compression.empty()) {
    chunk_ = bytes;
  } else if (compression == "zstd" || compression == "lz4") {
    chunk_ = unpacked(bytes, size, file_.path());
  } else {
    file_.fail(fmt::format("has a chunk compressed by '{}', which is not read",
                           printable_name(compression)));
  }
  if (chunk_.size() != size || (crc != 0 && crc != crc32_of(0, chunk_.data(), chunk_.size())))
    fail_damaged(file_, "the bytes of a chunk do not have its checksum");
  chunk_at_ = 0;
}

bool McapMessages::next(BagMessage& message) {
  for (Record record; next_record(record);) {
    if (record.kind != op::kMessage) continue;
    Fields f(file_, record.bytes);
    const auto channel = static_cast<std::uint16_t>(f.number(2));
    if (wanted_.count(channel) == 0) continue;
    message.channel = channel;
    f.number(4);
    const std::uint64_t t = f.number(8);
    f.number(8);
    const std::uint64_t seconds = t / 1000000000;
    message.received =
        static_cast<double>(seconds) + 1e-9 * static_cast<double>(t - 1000000000 * seconds);
    message.bytes = f.rest();
    message.size = static_cast<std::int64_t>(f.rest().size());
    return true;
  }
  return false;
}

}  // namespace tauext
