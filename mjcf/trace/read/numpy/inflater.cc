// SPDX-License-Identifier: Apache-2.0
#include "mjcf/trace/read/numpy/inflater.h"

#include <stdexcept>

#ifdef TAUEXT_ZLIB
#include <zlib.h>

#include <new>
#endif

namespace tauext {

#ifdef TAUEXT_ZLIB

void require_zlib() {}

std::uint32_t crc32_of(std::uint32_t before, const void* bytes, std::size_t count) {
  return static_cast<std::uint32_t>(::crc32_z(before, static_cast<const Bytef*>(bytes), count));
}

struct Inflater::Stream {
  z_stream z{};
};

Inflater::Inflater() : stream_(std::make_unique<Stream>()) {
  if (::inflateInit2(&stream_->z, -MAX_WBITS) != Z_OK) throw std::bad_alloc();  // -: no header
}

Inflater::~Inflater() {
  ::inflateEnd(&stream_->z);
}

Inflater::Step Inflater::step(const unsigned char* packed, std::size_t packed_size,
                              unsigned char* to, std::size_t size) {
  z_stream& z = stream_->z;
  z.next_in = const_cast<unsigned char*>(packed);
  z.avail_in = static_cast<uInt>(packed_size);
  z.next_out = to;
  z.avail_out = static_cast<uInt>(size);
  const int code = ::inflate(&z, Z_NO_FLUSH);
  return {packed_size - z.avail_in, size - z.avail_out,
          code == Z_OK || code == Z_STREAM_END || code == Z_BUF_ERROR, code == Z_STREAM_END};
}

#else

void require_zlib() {
  throw std::runtime_error(
      ".npz files are left out of this build: install Debian's zlib1g-dev, and build again");
}

std::uint32_t crc32_of(std::uint32_t, const void*, std::size_t) {
  require_zlib();
  return 0;
}

struct Inflater::Stream {};
Inflater::Inflater() {
  require_zlib();
}
Inflater::~Inflater() = default;
Inflater::Step Inflater::step(const unsigned char*, std::size_t, unsigned char*, std::size_t) {
  return {};
}

#endif

}  // namespace tauext
