// SPDX-License-Identifier: Apache-2.0
/// @file
/// Writes MCAP (mcap.dev/spec) with messages in JSON, which Foxglove and PlotJuggler open.
#pragma once

#include <cstddef>
#include <cstdint>
#include <future>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "mjcf/trace/atomic_file.h"

namespace tauext {

/// A topic of such a file.
struct McapTopic {
  std::string name;                             ///< "/measured"
  std::string type;                             ///< the name of its schema
  std::string schema;                           ///< json_schema()
  std::map<std::string, std::string> metadata;  ///< for people
};

/// A file that appears whole, by commit(), or not at all. Chunks of 1 MB are compressed by zstd in
/// a thread of their own, and written as they fill, with their index; a summary and checksums are
/// at the end. What stays in memory is some 100 bytes for each chunk.
class McapWriter {
 public:
  /// @throws std::runtime_error naming the path, also if libarchive or zlib were missing at build
  explicit McapWriter(const std::string& path);
  ~McapWriter();

  /// @returns the number by which write() knows it
  std::size_t add(const McapTopic& topic);
  /// @param t [s] in the file it is rounded to nanoseconds, and where the first is below 0, which
  /// no time of MCAP is, all are shifted so that it is 0
  /// @throws std::runtime_error naming the path, also for a time that is not from 0 to 1.8e10 then
  void write(std::size_t topic, double t, std::string_view message);
  /// @throws std::runtime_error naming the path
  void commit();

 private:
  struct Channel {
    std::string record;          // as the summary has it, too
    std::uint32_t messages = 0;  // so far
  };
  struct Times {
    std::uint64_t from = 0, to = 0;  // [ns]
    bool any = false;
    void take(std::uint64_t t);
  };
  struct Chunk {
    std::string bytes;
    Times times;
    std::vector<std::string> indices;  // of each channel: times, and places in it
  };
  struct Packed {
    std::string bytes;
    std::uint32_t crc = 0;  // of what they were
  };

  void put(std::string_view bytes);
  void flush();
  void finish_chunk();
  std::string write_indices();
  std::string summary();

  std::string path_;
  AtomicFile file_;
  std::uint64_t at_ = 0;   // [bytes] written
  std::uint32_t crc_ = 0;  // of these
  double shift_ = 0;       // [s]
  Times times_;
  std::vector<std::string> schemas_;  // records
  std::vector<Channel> channels_;
  std::string chunk_indices_;  // records
  std::uint32_t chunks_ = 0;
  Chunk chunk_, packing_;       // the one that fills, and the one that is being compressed
  std::future<Packed> packed_;  // which ends before that does
};

}  // namespace tauext
