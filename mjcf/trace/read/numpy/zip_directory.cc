// SPDX-License-Identifier: Apache-2.0
#include "mjcf/trace/read/numpy/zip_directory.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstddef>

namespace tauext {
namespace {

constexpr std::size_t kEndSize = 22, kLocatorSize = 20, kEnd64Size = 56;
constexpr std::size_t kEntrySize = 46, kLocalSize = 30;
constexpr std::size_t kMostDirectory = 1 << 20;  // [bytes]
constexpr std::uint64_t kIn64 = 0xFFFFFFFF;      // the number stands among those of 64 bits

struct Place {
  std::uint64_t offset = 0, size = 0;
};

bool signed_as(const unsigned char* bytes, unsigned char third, unsigned char fourth) {
  return bytes[0] == 'P' && bytes[1] == 'K' && bytes[2] == third && bytes[3] == fourth;
}

Place directory_of_64(const ByteFile& file, std::uint64_t end) {
  std::array<unsigned char, kLocatorSize> locator{};
  std::array<unsigned char, kEnd64Size> end64{};
  if (end >= kLocatorSize) file.read(end - kLocatorSize, locator.data(), kLocatorSize);
  const std::uint64_t at = little_endian(&locator[8], 8);
  if (!signed_as(locator.data(), 6, 7) || !file.has(at, kEnd64Size)) {
    file.fail("the end of its directory is damaged");
  }
  file.read(at, end64.data(), kEnd64Size);
  if (!signed_as(end64.data(), 6, 6)) file.fail("the end of its directory is damaged");
  return {little_endian(&end64[48], 8), little_endian(&end64[40], 8)};
}

Place directory_of(const ByteFile& file) {
  constexpr std::size_t kComment = 65535;
  std::vector<unsigned char> tail(std::min<std::uint64_t>(file.size(), kEndSize + kComment));
  file.read(file.size() - tail.size(), tail.data(), tail.size());
  for (std::size_t left = kEndSize; left <= tail.size(); ++left) {
    const unsigned char* const end = &tail[tail.size() - left];
    if (!signed_as(end, 5, 6) || little_endian(end + 20, 2) != left - kEndSize) continue;
    const Place place{little_endian(end + 16, 4), little_endian(end + 12, 4)};
    const bool in_64 = place.offset == kIn64 || place.size == kIn64;
    return in_64 ? directory_of_64(file, file.size() - left) : place;
  }
  file.fail("has no directory at its end: it is cut off, or no .npz");
}

// the numbers of 64 bits of those that do not fit into 32, in this order
bool take_64(const unsigned char* extra, std::size_t size, ZipMember& member) {
  const auto missing = [&] {
    return member.size == kIn64 || member.packed == kIn64 || member.header == kIn64;
  };
  while (missing() && size >= 4) {
    const std::size_t length = little_endian(extra + 2, 2);
    if (length > size - 4) return false;
    std::size_t at = 0;
    if (little_endian(extra, 2) == 1) {
      for (std::uint64_t* n : {&member.size, &member.packed, &member.header}) {
        if (*n != kIn64) continue;
        if (length - at < 8) return false;
        *n = little_endian(extra + 4 + at, 8);
        at += 8;
      }
      return true;
    }
    extra += 4 + length;
    size -= 4 + length;
  }
  return !missing();
}

// the bytes of the entry; 0 if it is none
std::size_t take_entry(const unsigned char* e, std::size_t left, ZipMember& member) {
  if (left < kEntrySize || !signed_as(e, 1, 2)) return 0;
  const std::size_t name = little_endian(e + 28, 2), extra = little_endian(e + 30, 2);
  const std::size_t size = kEntrySize + name + extra + little_endian(e + 32, 2);
  if (size > left) return 0;
  member.encrypted = (little_endian(e + 8, 2) & 1) != 0;
  member.method = static_cast<int>(little_endian(e + 10, 2));
  member.crc = static_cast<std::uint32_t>(little_endian(e + 16, 4));
  member.packed = little_endian(e + 20, 4);
  member.size = little_endian(e + 24, 4);
  member.header = little_endian(e + 42, 4);
  member.name.assign(reinterpret_cast<const char*>(e + kEntrySize), name);
  return take_64(e + kEntrySize + name, extra, member) ? size : 0;
}

}  // namespace

std::vector<ZipMember> zip_members(const ByteFile& file) {
  const Place place = directory_of(file);
  if (!file.has(place.offset, place.size)) file.fail("its directory lies beyond its end");
  if (place.size > kMostDirectory) file.fail("its directory is longer than 1 MB");
  std::vector<unsigned char> directory(place.size);
  file.read(place.offset, directory.data(), directory.size());
  std::vector<ZipMember> members;
  for (std::size_t at = 0; at < directory.size();) {
    ZipMember member;
    const std::size_t size = take_entry(&directory[at], directory.size() - at, member);
    if (size == 0) file.fail("its directory is damaged");
    members.push_back(std::move(member));
    at += size;
  }
  return members;
}

std::uint64_t zip_data(const ByteFile& file, const ZipMember& member) {
  std::array<unsigned char, kLocalSize> header{};
  if (!file.has(member.header, kLocalSize)) file.fail("its directory points beyond its end");
  file.read(member.header, header.data(), kLocalSize);
  if (!signed_as(header.data(), 3, 4)) file.fail("its directory points to what is no member");
  return member.header + kLocalSize + little_endian(&header[26], 2) + little_endian(&header[28], 2);
}

}  // namespace tauext
