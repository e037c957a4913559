// SPDX-License-Identifier: Apache-2.0
#include "mjcf/trace/read/text/unpacked_file.h"

#include <fmt/format.h>
#ifdef TAUEXT_ARCHIVE
#include <archive.h>
#include <archive_entry.h>
#endif
#ifdef TAUEXT_ZLIB
#include <zlib.h>
#endif

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <new>
#include <optional>
#include <stdexcept>

#include "mjcf/trace/input_file.h"
#include "mjcf/trace/printable.h"

namespace tauext {
namespace {

// how what a program has packed begins
struct Packer {
  std::string_view magic, program;
};
constexpr std::string_view kGzip = "gzip";
constexpr Packer kPackers[] = {{"\x1f\x8b", kGzip},
                               {std::string_view("\xfd\x37zXZ\0", 6), "xz"},
                               {"\x28\xb5\x2f\xfd", "zstd"},
                               {"BZh", "bzip2"},
                               {"\x04\x22\x4d\x18", "lz4"}};

// "": of none
std::string_view packer_of(std::string_view begin) {
  for (const Packer& p : kPackers)
    if (begin.starts_with(p.magic)) return p.program;
  return "";
}

[[noreturn]] void fail(const std::string& path, const std::string& why) {
  throw std::runtime_error(fmt::format("{}: {}", path, why));
}

// "run.csv.zst" is part.csv without it; bytes that no program has packed are a chunk of MCAP
[[noreturn]] void fail_unpacking(const std::string& path, std::string_view program,
                                 std::string_view why) {
  const std::string remedy =
      program.empty() ? "; `mcap recover` makes a file of what is whole"
                      : fmt::format("; {} -dc {} > part{} gets what is before that", program, path,
                                    std::filesystem::path(path).stem().extension().string());
  fail(path, one_line(fmt::format("cannot be unpacked: {}{}", why, remedy)));
}

using Stream = std::unique_ptr<std::FILE, int (*)(std::FILE*)>;

Stream opened(const std::string& path) {
  claim_input(path);
  Stream file(std::fopen(path.c_str(), "rbe"), std::fclose);
  if (!file) fail(path, std::strerror(errno));
  std::setvbuf(file.get(), nullptr, _IONBF, 0);
  return file;
}

}  // namespace

bool is_compressed(std::string_view begin) {
  return !packer_of(begin).empty();
}

namespace detail {

#ifdef TAUEXT_ARCHIVE

class Unpacker {
 public:
  // of a file that this program has packed, or of bytes in it, which must outlive this
  Unpacker(const std::string& path, std::string_view program,
           const std::string_view* bytes = nullptr)
      : path_(path), program_(program), archive_(archive_read_new(), archive_read_free) {
    if (!archive_) throw std::bad_alloc();
    for (auto* knows : {archive_read_support_filter_xz, archive_read_support_filter_zstd,
                        archive_read_support_filter_bzip2, archive_read_support_filter_lz4,
                        archive_read_support_format_raw, archive_read_support_format_empty})
      require(knows(archive_.get()));
    require(bytes == nullptr
                ? archive_read_open_filename(archive_.get(), path.c_str(), 1 << 16)
                : archive_read_open_memory(archive_.get(), bytes->data(), bytes->size()));
    archive_entry* entry = nullptr;
    require(archive_read_next_header(archive_.get(), &entry));
  }

  std::size_t read(char* to, std::size_t most) {
    const la_ssize_t got = archive_read_data(archive_.get(), to, most);
    if (got < 0) require(static_cast<int>(got));
    return static_cast<std::size_t>(got);
  }

 private:
  // a warning, too: a filter that would have to run another program
  void require(int code) const {
    if (code == ARCHIVE_OK) return;
    const char* const why = archive_error_string(archive_.get());
    fail_unpacking(path_, program_, why == nullptr ? "it is damaged" : why);
  }

  std::string path_;
  std::string_view program_;
  std::unique_ptr<archive, int (*)(archive*)> archive_;
};

#else

class Unpacker {
 public:
  Unpacker(const std::string& path, std::string_view, const std::string_view* = nullptr) {
    fail(path,
         "is compressed, and what unpacks it is left out of this build: install Debian's "
         "libarchive-dev, and build again");
  }
  std::size_t read(char*, std::size_t) { return 0; }
};

#endif

#ifdef TAUEXT_ZLIB

// gzip, of which libarchive does not compare the checksum
class Gunzipper {
 public:
  explicit Gunzipper(const std::string& path)
      : path_(path), file_(::gzopen(path.c_str(), "rbe"), ::gzclose) {
    if (!file_) fail(path, std::strerror(errno));
  }

  std::size_t read(char* to, std::size_t most) {
    const int got = ::gzread(file_.get(), to, static_cast<unsigned>(std::min(most, kMost)));
    int code = Z_OK;
    std::string_view why = ::gzerror(file_.get(), &code);
    if (why.starts_with(path_ + ": ")) why.remove_prefix(path_.size() + 2);
    if (got < 0 || (code != Z_OK && code != Z_STREAM_END)) fail_unpacking(path_, kGzip, why);
    return static_cast<std::size_t>(got);
  }

 private:
  static constexpr std::size_t kMost = 1 << 30;  // [bytes] at once

  std::string path_;
  std::unique_ptr<gzFile_s, int (*)(gzFile)> file_;
};

#else

class Gunzipper {
 public:
  explicit Gunzipper(const std::string& path) {
    fail(path,
         "is compressed, and what unpacks it is left out of this build: install Debian's "
         "zlib1g-dev, and build again");
  }
  std::size_t read(char*, std::size_t) { return 0; }
};

#endif

}  // namespace detail

#ifdef TAUEXT_ZLIB
std::uint32_t crc32_of(std::uint32_t before, const void* bytes, std::size_t count) {
  return static_cast<std::uint32_t>(::crc32_z(before, static_cast<const Bytef*>(bytes), count));
}
#else
std::uint32_t crc32_of(std::uint32_t, const void*, std::size_t) {
  throw std::runtime_error(
      "checksums are left out of this build: install Debian's zlib1g-dev, and build again");
}
#endif

std::string unpacked(std::string_view bytes, std::size_t size, const std::string& path) {
  detail::Unpacker from(path, "", &bytes);
  std::string all(size + 1, '\0');
  std::size_t got = 0;
  for (std::size_t some = 1; some > 0 && got < all.size(); got += some)
    some = from.read(all.data() + got, all.size() - got);
  all.resize(got);
  return all;
}

struct UnpackedFile::Source {
  explicit Source(const std::string& p) : path(p), file(opened(p)) {
    std::array<char, 8> begin{};
    const std::size_t size = std::fread(begin.data(), 1, begin.size(), file.get());
    const std::string_view bytes(begin.data(), size);
    const std::string_view packer = packer_of(bytes);
    if (packer == kGzip) {
      gzip.emplace(path);
    } else if (!packer.empty()) {
      packed.emplace(path, packer);
    } else {
      first.assign(begin.data(), size);  // a pipe has no way back
    }
  }

  std::size_t read(char* to, std::size_t most) {
    if (gzip) return gzip->read(to, most);
    if (packed) return packed->read(to, most);
    if (!first.empty()) {
      const std::size_t some = first.copy(to, most);
      first.erase(0, some);
      return some;
    }
    errno = 0;
    const std::size_t got = std::fread(to, 1, most, file.get());
    if (std::ferror(file.get()) != 0) fail(path, std::strerror(errno));
    return got;
  }

  std::string path, first;
  Stream file;
  std::optional<detail::Gunzipper> gzip;
  std::optional<detail::Unpacker> packed;
};

UnpackedFile::UnpackedFile(const std::string& path) : source_(std::make_unique<Source>(path)) {}
UnpackedFile::~UnpackedFile() = default;

std::size_t UnpackedFile::read(char* to, std::size_t most) {
  return source_->read(to, most);
}

}  // namespace tauext
