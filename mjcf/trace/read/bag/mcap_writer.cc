// SPDX-License-Identifier: Apache-2.0
#include "mjcf/trace/read/bag/mcap_writer.h"

#include <fmt/format.h>

#include "mjcf/trace/byte_order.h"
#include "mjcf/trace/read/text/unpacked_file.h"
#ifdef TAUEXT_ARCHIVE
#include <archive.h>
#include <archive_entry.h>
#endif

#include <algorithm>
#include <cmath>
#include <memory>
#include <new>
#include <stdexcept>
#include <utility>

namespace tauext {
namespace {

// kinds of records
namespace kind {
constexpr std::uint8_t kHeader = 1, kFooter = 2, kSchema = 3, kChannel = 4, kMessage = 5,
                       kChunk = 6, kMessageIndex = 7, kChunkIndex = 8, kStatistics = 11,
                       kSummaryOffset = 14, kDataEnd = 15;
}

constexpr std::string_view kMcapMagic = "\x89MCAP0\r\n";
constexpr std::size_t kFullChunk = 1 << 20;  // [bytes]
constexpr const char* kZstd = "zstd";

// fields of a record, the low byte of a number first
class RecordText {
 public:
  RecordText& number(std::uint64_t x, std::size_t size) { return raw(to_bytes(x, size)); }
  RecordText& text(std::string_view s) { return number(s.size(), 4).raw(s); }
  RecordText& raw(std::string_view s) {
    bytes_ += s;
    return *this;
  }
  const std::string& bytes() const { return bytes_; }
  std::string as(std::uint8_t kind) const {
    return RecordText().number(kind, 1).number(bytes_.size(), 8).raw(bytes_).bytes();
  }

 private:
  std::string bytes_;
};

#if defined(TAUEXT_ARCHIVE) && defined(TAUEXT_ZLIB)

void require_packer(const std::string&) {}

// by zstd, level 1
std::string packed(std::string_view bytes, const std::string& path) {
  const std::unique_ptr<archive, int (*)(archive*)> to(archive_write_new(), archive_write_free);
  const std::unique_ptr<archive_entry, void (*)(archive_entry*)> entry(archive_entry_new(),
                                                                       archive_entry_free);
  if (!to || !entry) throw std::bad_alloc();
  const auto require = [&](int code) {  // a warning, too: a filter that would run another program
    if (code == ARCHIVE_OK) return;
    const char* const why = archive_error_string(to.get());
    throw std::runtime_error(
        fmt::format("{}: cannot be compressed: {}", path, why == nullptr ? "out of memory" : why));
  };
  std::string all(bytes.size() + bytes.size() / 64 + 4096, '\0');
  std::size_t used = 0;
  require(archive_write_add_filter_zstd(to.get()));
  require(archive_write_set_filter_option(to.get(), kZstd, "compression-level", "1"));
  require(archive_write_set_format_raw(to.get()));
  require(archive_write_open_memory(to.get(), all.data(), all.size(), &used));
  archive_entry_set_filetype(entry.get(), AE_IFREG);
  require(archive_write_header(to.get(), entry.get()));
  const la_ssize_t put = archive_write_data(to.get(), bytes.data(), bytes.size());
  if (put < 0) require(static_cast<int>(put));
  require(archive_write_close(to.get()));
  all.resize(used);
  return all;
}

#else

void require_packer(const std::string& path) {
  throw std::runtime_error(path +
                           ": MCAP is not written by this build: install Debian's libarchive-dev "
                           "and zlib1g-dev, and build again");
}

std::string packed(std::string_view bytes, const std::string&) {
  return std::string(bytes);
}

#endif

}  // namespace

void McapWriter::Times::take(std::uint64_t t) {
  from = any ? std::min(from, t) : t;
  to = any ? std::max(to, t) : t;
  any = true;
}

McapWriter::McapWriter(const std::string& path) : path_(path), file_(path) {
  require_packer(path_);
  for (Chunk* c : {&chunk_, &packing_}) c->bytes.reserve(kFullChunk + kFullChunk / 8);
  put(kMcapMagic);
  put(RecordText().text("").text("tauext").as(kind::kHeader));
}

McapWriter::~McapWriter() = default;

void McapWriter::put(std::string_view bytes) {
  file_.write(bytes);
  crc_ = crc32_of(crc_, bytes.data(), bytes.size());
  at_ += bytes.size();
}

std::size_t McapWriter::add(const McapTopic& topic) {
  const auto record_of = [&](std::size_t id) {
    return RecordText()
        .number(id, 2)
        .text(topic.type)
        .text("jsonschema")
        .text(topic.schema)
        .as(kind::kSchema);
  };
  std::size_t schema = 1;
  while (schema <= schemas_.size() && schemas_[schema - 1] != record_of(schema)) ++schema;
  if (schema > schemas_.size()) {
    schemas_.push_back(record_of(schema));
    chunk_.bytes += schemas_.back();
  }
  RecordText metadata;
  for (const auto& [key, value] : topic.metadata) metadata.text(key).text(value);
  channels_.push_back({RecordText()
                           .number(channels_.size(), 2)
                           .number(schema, 2)
                           .text(topic.name)
                           .text("json")
                           .text(metadata.bytes())
                           .as(kind::kChannel),
                       0});
  chunk_.bytes += channels_.back().record;
  for (Chunk* c : {&chunk_, &packing_}) c->indices.resize(channels_.size());
  return channels_.size() - 1;
}

void McapWriter::write(std::size_t topic, double t, std::string_view message) {
  constexpr double kMost = 1.8e10;   // [s] of 64 bits
  constexpr std::size_t kHead = 22;  // [bytes] before a message
  const bool is_first = chunks_ == 0 && !packed_.valid() && !chunk_.times.any;
  if (is_first && t < 0 && t >= -kMost) shift_ = -t;
  t += shift_;
  if (!(t >= 0 && t <= kMost))
    throw std::runtime_error(
        fmt::format("{}: t = {} s: MCAP has no time below that of the first sample or 0, nor "
                    "above {:g} s: write a .csv, or shift those of the log",
                    path_, t - shift_, kMost));
  const double whole = std::floor(t);
  const std::uint64_t ns = static_cast<std::uint64_t>(whole) * 1'000'000'000 +
                           static_cast<std::uint64_t>(std::llround((t - whole) * 1e9));
  const std::string time = to_bytes(ns, 8);
  chunk_.indices[topic] += time;
  chunk_.indices[topic] += to_bytes(chunk_.bytes.size(), 8);
  std::string& to = chunk_.bytes;
  to += kind::kMessage;
  to += to_bytes(kHead + message.size(), 8);
  to += to_bytes(topic, 2);
  to += to_bytes(channels_[topic].messages++, 4);
  to += time;  // logged
  to += time;  // published
  to += message;
  chunk_.times.take(ns);
  if (to.size() >= kFullChunk) flush();
}

// hands the chunk over, when the one before it is written
void McapWriter::flush() {
  finish_chunk();
  if (chunk_.bytes.empty()) return;
  std::swap(chunk_, packing_);
  // where there can be no thread, it waits for get()
  packed_ = std::async(std::launch::async | std::launch::deferred, [this]() -> Packed {
    const std::string& bytes = packing_.bytes;
    return {packed(bytes, path_), crc32_of(0, bytes.data(), bytes.size())};
  });
}

void McapWriter::finish_chunk() {
  if (!packed_.valid()) return;
  const Packed done = packed_.get();
  const Times times = std::exchange(packing_.times, {});
  const std::string head = RecordText()
                               .number(times.from, 8)
                               .number(times.to, 8)
                               .number(packing_.bytes.size(), 8)
                               .number(done.crc, 4)
                               .text(kZstd)
                               .number(done.bytes.size(), 8)
                               .bytes();
  const std::uint64_t begin = at_;
  put(RecordText().number(kind::kChunk, 1).number(head.size() + done.bytes.size(), 8).bytes());
  put(head);
  put(done.bytes);
  const std::uint64_t end = at_;
  const std::string places = write_indices();
  chunk_indices_ += RecordText()
                        .number(times.from, 8)
                        .number(times.to, 8)
                        .number(begin, 8)
                        .number(end - begin, 8)
                        .text(places)
                        .number(at_ - end, 8)
                        .text(kZstd)
                        .number(done.bytes.size(), 8)
                        .number(packing_.bytes.size(), 8)
                        .as(kind::kChunkIndex);
  ++chunks_;
  if (times.any) times_.take(times.from), times_.take(times.to);
  packing_.bytes.clear();
}

// of the chunk; where those of each channel are
std::string McapWriter::write_indices() {
  RecordText places;
  for (std::size_t id = 0; id < packing_.indices.size(); ++id) {
    std::string& index = packing_.indices[id];
    if (index.empty()) continue;
    places.number(id, 2).number(at_, 8);
    put(RecordText().number(id, 2).text(index).as(kind::kMessageIndex));
    index.clear();
  }
  return places.bytes();
}

// and where each kind of its records is
std::string McapWriter::summary() {
  std::string records;
  RecordText offsets;
  const auto add = [&](std::uint8_t kind, const std::string& group) {
    if (group.empty()) return;
    offsets.raw(RecordText()
                    .number(kind, 1)
                    .number(at_ + records.size(), 8)
                    .number(group.size(), 8)
                    .as(kind::kSummaryOffset));
    records += group;
  };
  std::string schemas, channels;
  for (const std::string& s : schemas_) schemas += s;
  RecordText counts;
  std::uint64_t messages = 0;
  for (std::size_t id = 0; id < channels_.size(); ++id) {
    channels += channels_[id].record;
    counts.number(id, 2).number(channels_[id].messages, 8);
    messages += channels_[id].messages;
  }
  add(kind::kSchema, schemas);
  add(kind::kChannel, channels);
  add(kind::kStatistics, RecordText()
                             .number(messages, 8)
                             .number(schemas_.size(), 2)
                             .number(channels_.size(), 4)
                             .number(0, 4)
                             .number(0, 4)
                             .number(chunks_, 4)
                             .number(times_.from, 8)
                             .number(times_.to, 8)
                             .text(counts.bytes())
                             .as(kind::kStatistics));
  add(kind::kChunkIndex, chunk_indices_);
  const std::uint64_t offsets_begin = at_ + records.size();
  // the head of the footer, too, is in its checksum
  return records + offsets.bytes() +
         RecordText()
             .number(kind::kFooter, 1)
             .number(20, 8)
             .number(at_, 8)
             .number(offsets_begin, 8)
             .bytes();
}

void McapWriter::commit() {
  flush();
  finish_chunk();
  put(RecordText().number(crc_, 4).as(kind::kDataEnd));
  const std::string end = summary();
  put(end);
  put(RecordText().number(crc32_of(0, end.data(), end.size()), 4).raw(kMcapMagic).bytes());
  file_.commit();
}

}  // namespace tauext
