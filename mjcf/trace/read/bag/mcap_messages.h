// SPDX-License-Identifier: Apache-2.0
/// @file
/// The messages of some topics in a bag of the storage mcap (mcap.dev/spec), in its order.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>

#include "mjcf/trace/read/bag/bag_messages.h"
#include "mjcf/trace/read/text/byte_file.h"

namespace tauext {

/// Those of some topics. Chunks may be compressed by zstd or lz4, and
/// have up to 256 MB. A file that ends too early is read up to its last whole record, and one of
/// which a chunk is damaged up to that chunk, unless it is the first.
class McapMessages final : public BagMessages {
 public:
  /// @throws std::runtime_error as BagRows does
  explicit McapMessages(const std::string& path);

  bool next(BagMessage& message) override;
  void rewind() override;
  std::string note() const override;

 protected:
  void select() override;

 private:
  struct Record {
    std::uint8_t kind = 0;
    std::string_view bytes;  // until the next one is read
    std::uint64_t size = 0;  // [bytes] even so
  };
  struct Schema {
    std::string type, language, definition;  // as BagTopic has them
  };
  struct Channel {
    std::uint16_t schema = 0;
    std::string topic, encoding;
  };

  bool next_record(Record& record);
  bool end(bool closed);
  bool next_in_chunk(Record& record);
  bool take_chunk(std::uint64_t begin);
  void open_chunk(std::uint64_t begin);
  void read_summary();
  void learn(const Record& record);

  ByteFile file_;
  std::uint64_t at_ = 0, end_ = 0;  // in the file: the next record; where they end
  bool ended_ = false;
  std::optional<std::uint64_t> lost_;  // [bytes] behind the last record of a file without its end
  bool any_chunk_ = false;             // was opened
  std::string damage_;                 // of the first chunk that is not read
  std::string record_, chunk_;
  std::size_t chunk_at_ = 0;
  std::map<std::uint16_t, Schema> schemas_;
  std::map<std::uint16_t, Channel> channels_;
  std::set<std::uint16_t> wanted_;  // channels of the topics
};

}  // namespace tauext
