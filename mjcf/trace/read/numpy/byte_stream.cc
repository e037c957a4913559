// SPDX-License-Identifier: Apache-2.0
#include "mjcf/trace/read/numpy/byte_stream.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <stdexcept>
#include <utility>

namespace tauext {
namespace {

constexpr std::size_t kBlock = 1 << 14;  // [bytes]

}  // namespace

Extent extent_of(const ByteFile& file) {
  return {file.path(), 0, file.size(), file.size(), false, {}};
}

Extent extent_of(const ByteFile& file, const ZipMember& member, const std::string& what) {
  constexpr std::uint64_t kMostRatio = 1032;  // of deflate: 258 bytes by 2 bits
  const auto fail = [&](const std::string& why) {
    throw std::runtime_error(fmt::format("{}: {}", what, why));
  };
  if (member.encrypted) fail("is encrypted");
  if (member.method != 0 && member.method != 8) {
    fail(fmt::format("is packed by method {}, where 0 (stored) and 8 (deflated) are known",
                     member.method));
  }
  Extent e{what,        zip_data(file, member), member.packed,
           member.size, member.method == 8,     member.crc};
  if (!file.has(e.offset, e.packed)) fail("lies beyond the end of the file");
  const std::uint64_t most = e.deflated ? e.packed * kMostRatio : e.packed;
  if (e.size > most || (!e.deflated && e.size != e.packed)) {
    fail(fmt::format("has {} bytes, which cannot be {} unpacked", e.packed, e.size));
  }
  return e;
}

ByteStream::ByteStream(const ByteFile& file, Extent extent, bool checked)
    : file_(file),
      extent_(std::move(extent)),
      checked_(checked && extent_.crc.has_value()),
      block_(kBlock) {
  if (!extent_.deflated) return;
  packed_.resize(kBlock);
  inflater_ = std::make_unique<Inflater>();
}

void ByteStream::read(void* to, std::size_t count) {
  auto* out = static_cast<unsigned char*>(to);
  while (count > 0) {
    if (at_ == end_) fill();
    const std::size_t n = std::min(count, end_ - at_);
    std::memcpy(out, &block_[at_], n);
    at_ += n;
    out += n;
    count -= n;
  }
}

void ByteStream::skip(std::uint64_t count) {
  while (count > 0) {
    if (at_ == end_ && !extent_.deflated && !checked_ && count <= extent_.size - taken_) {
      taken_ += count;
      return;
    }
    if (at_ == end_) fill();
    const auto n = std::min<std::uint64_t>(count, end_ - at_);
    at_ += n;
    count -= n;
  }
}

void ByteStream::fill() {
  const auto most = std::min<std::uint64_t>(kBlock, extent_.size - taken_);
  if (most == 0) fail(fmt::format("ends after {} bytes", extent_.size));
  at_ = 0;
  end_ = most;
  if (extent_.deflated) {
    end_ = unpack(most);
  } else {
    file_.read(extent_.offset + taken_, block_.data(), most);
  }
  taken_ += end_;
  if (!checked_) return;
  crc_ = crc32_of(crc_, block_.data(), end_);
  if (taken_ == extent_.size && crc_ != *extent_.crc) {
    fail("its bytes do not have its checksum: the file is damaged");
  }
}

// at least one byte, and at most so many
std::size_t ByteStream::unpack(std::size_t most) {
  for (;;) {
    if (packed_at_ == packed_end_) {
      packed_at_ = 0;
      packed_end_ = std::min<std::uint64_t>(kBlock, extent_.packed - packed_taken_);
      file_.read(extent_.offset + packed_taken_, packed_.data(), packed_end_);
      packed_taken_ += packed_end_;
    }
    const Inflater::Step step =
        inflater_->step(&packed_[packed_at_], packed_end_ - packed_at_, block_.data(), most);
    packed_at_ += step.used;
    if (!step.good) fail("cannot be unpacked: the file is damaged");
    if (step.made > 0) return step.made;
    if (step.end || step.used == 0) {
      fail(fmt::format("is cut off: {} of {} bytes", taken_, extent_.size));
    }
  }
}

void ByteStream::fail(const std::string& why) const {
  throw std::runtime_error(fmt::format("{}: {}", extent_.what, why));
}

}  // namespace tauext
