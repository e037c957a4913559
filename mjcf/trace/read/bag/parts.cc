// SPDX-License-Identifier: Apache-2.0
#include "mjcf/trace/read/bag/parts.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <sstream>
#include <stdexcept>
#include <utility>
#include <vector>

#include "mjcf/trace/input_file.h"
#include "mjcf/trace/printable.h"
#include "mjcf/trace/read/bag/mcap_messages.h"
#include "mjcf/trace/read/bag/sqlite_messages.h"
#include "mjcf/trace/read/text/byte_file.h"
#include "mjcf/trace/read/text/unpacked_file.h"

namespace tauext {
namespace {

namespace fs = std::filesystem;

constexpr const char* kMetadata = "metadata.yaml";

bool begins_as_mcap(std::string_view begin) {
  return begin.starts_with("\x89MCAP0\r\n");
}
bool begins_as_sqlite(std::string_view begin) {
  return begin.starts_with(std::string_view("SQLite format 3\0", 16));
}

// the first bytes, as they are
std::string begin_of(const std::string& path) {
  const ByteFile file(path);
  std::string begin(std::min<std::uint64_t>(file.size(), 16), '\0');
  file.read(0, begin.data(), begin.size());
  return begin;
}

// x.db3, x.mcap, and the same with the ending of a compressed file
bool is_part(const fs::path& path) {
  const auto bag = [](const fs::path& p) {
    return p.extension() == ".db3" || p.extension() == ".mcap";
  };
  return bag(path) || bag(path.stem());
}

// "x_2.db3" before "x_10.db3"
bool before(const std::string& a, const std::string& b) {
  return std::pair(a.size(), a) < std::pair(b.size(), b);
}

// of "relative_file_paths:" the items of the list below it
std::vector<std::string> listed_parts(const std::string& metadata) {
  std::vector<std::string> names;
  std::istringstream lines(read_whole(metadata, std::size_t{1} << 24));
  bool inside = false;
  for (std::string line; std::getline(lines, line);) {
    const std::size_t begin = line.find_first_not_of(" \t");
    const std::size_t end = line.find_last_not_of(" \t\r\"'");
    if (begin == line.npos || end == line.npos) continue;
    const std::string_view text = std::string_view(line).substr(begin, end + 1 - begin);
    if (text.starts_with("relative_file_paths:")) {
      inside = true;
    } else if (inside && text.starts_with("- ")) {
      names.emplace_back(text.substr(std::min(text.find_first_not_of(" \t\"'", 1), text.size())));
    } else {
      inside = false;
    }
  }
  return names;
}

std::vector<std::string> parts_of(const std::string& folder) {
  std::vector<std::string> parts;
  const std::string metadata = (fs::path(folder) / kMetadata).string();
  if (fs::exists(metadata)) {
    for (const std::string& name : listed_parts(metadata)) {
      // the oldest bags name their folder, too
      fs::path part = fs::path(folder) / name;
      if (!fs::exists(part)) part = fs::path(folder) / fs::path(name).filename();
      if (!fs::exists(part))
        throw std::runtime_error(fmt::format("{}: {} names the part {}, which is not there", folder,
                                             kMetadata, printable_name(name, 200)));
      parts.push_back(part.string());
    }
    if (!parts.empty()) return parts;
  }
  for (const fs::directory_entry& e : fs::directory_iterator(folder))
    if (is_part(e.path())) parts.push_back(e.path().string());
  std::sort(parts.begin(), parts.end(), before);
  return parts;
}

// the bytes of a compressed file in one that has no name
class UnpackedCopy {
 public:
  explicit UnpackedCopy(const std::string& path) {
    std::error_code error;
    const std::string folder = fs::temp_directory_path(error).string();
    errno = error.value();
    if (error) fail(path, "the folder for temporary files");
    std::string name = folder + "/tauext_XXXXXX";
    fd_ = ::mkostemp(name.data(), O_CLOEXEC);
    if (fd_ < 0) fail(path, folder);
    ::unlink(name.c_str());
    try {
      fill(path, folder);
    } catch (...) {
      ::close(fd_);
      throw;
    }
  }
  ~UnpackedCopy() { ::close(fd_); }
  UnpackedCopy(const UnpackedCopy&) = delete;
  UnpackedCopy& operator=(const UnpackedCopy&) = delete;

  std::string path() const { return fmt::format("/proc/self/fd/{}", fd_); }

 private:
  [[noreturn]] static void fail(const std::string& path, const std::string& folder) {
    throw std::runtime_error(
        fmt::format("{}: cannot be unpacked into {}: {}; TMPDIR names another "
                    "folder",
                    path, folder, std::strerror(errno)));
  }

  // a text of one letter shrinks to a thousandth, and a bag to a tenth
  void fill(const std::string& path, const std::string& folder) const {
    constexpr std::uint64_t kMostTimes = 200, kAlways = std::uint64_t{1} << 30;  // [bytes]
    const std::uint64_t most = kAlways + kMostTimes * fs::file_size(path);
    UnpackedFile from(path);
    std::vector<char> some(1 << 20);
    std::uint64_t size = 0;
    for (std::size_t got = 0; (got = from.read(some.data(), some.size())) > 0;) {
      size += got;
      if (size > most)
        throw std::runtime_error(
            fmt::format("{}: has more than {} times its size when it is unpacked: unpack it first",
                        path, kMostTimes));
      for (std::size_t at = 0; at < got;) {
        const ssize_t n = ::write(fd_, some.data() + at, got - at);
        if (n < 0 && errno == EINTR) continue;
        if (n <= 0) fail(path, folder);
        at += static_cast<std::size_t>(n);
      }
    }
  }

  int fd_ = -1;
};

// one file, unpacked where it has to be; errors name it as its user does
class PartMessages final : public BagMessages {
 public:
  explicit PartMessages(const std::string& path) : name_(path) {
    std::string begin = begin_of(path);
    std::string file = path;
    if (is_compressed(begin)) {
      copy_ = std::make_unique<UnpackedCopy>(path);
      file = copy_->path();
      begin = begin_of(file);
    }
    as_named([&] {
      if (begins_as_mcap(begin)) {
        inner_ = std::make_unique<McapMessages>(file);
      } else if (begins_as_sqlite(begin)) {
        inner_ = open_sqlite_bag(file);
      } else {
        throw std::runtime_error(file + ": begins as no bag of ROS 2 does (.db3, .mcap)");
      }
    });
    add_topics(inner_->topics());
  }

  bool next(BagMessage& message) override {
    bool any = false;
    as_named([&] { any = inner_->next(message); });
    return any;
  }
  void rewind() override {
    as_named([&] { inner_->rewind(); });
  }
  std::string note() const override { return inner_->note(); }

 protected:
  void select() override {
    as_named([&] { inner_->take(topic()); });
    set_definition(inner_->topic().language, inner_->topic().definition);
  }

 private:
  template <class Work>
  void as_named(Work&& work) {
    try {
      work();
    } catch (const std::runtime_error& e) {
      if (!copy_) throw;
      std::string what = e.what();
      const std::string file = copy_->path();
      for (std::size_t at = 0; (at = what.find(file, at)) != what.npos; at += name_.size())
        what.replace(at, file.size(), name_);
      throw std::runtime_error(what);
    }
  }

  std::string name_;
  std::unique_ptr<UnpackedCopy> copy_;
  std::unique_ptr<BagMessages> inner_;
};

// several files as one recording, of which one at a time is open
class FolderMessages final : public BagMessages {
 public:
  explicit FolderMessages(std::vector<std::string> parts) : parts_(std::move(parts)) {
    for (const std::string& part : parts_) add_topics(PartMessages(part).topics());
  }

  bool next(BagMessage& message) override {
    for (; at_ < parts_.size(); ++at_, part_.reset()) {
      if (!part_ && !open_part()) continue;
      if (part_->next(message)) return true;
      const std::string note = part_->note();
      if (!note.empty())
        note_ += fmt::format("{}{}: {}", note_.empty() ? "" : "; ", parts_[at_], note);
    }
    return false;
  }
  void rewind() override {
    at_ = 0;
    part_.reset();
    note_.clear();
  }
  std::string note() const override { return note_; }

 protected:
  void select() override {
    rewind();
    for (; at_ < parts_.size(); ++at_)
      if (open_part()) break;
    if (part_) set_definition(part_->topic().language, part_->topic().definition);
    rewind();
  }

 private:
  // false: this one has no such topic
  bool open_part() {
    part_ = std::make_unique<PartMessages>(parts_[at_]);
    for (const BagTopic& t : part_->topics()) {
      if (!is_chosen(t)) continue;
      part_->take(topic());
      return true;
    }
    return false;
  }

  std::vector<std::string> parts_;
  std::size_t at_ = 0;
  std::unique_ptr<PartMessages> part_;
  std::string note_;
};

}  // namespace

bool is_bag(const std::string& path) {
  std::error_code none;
  if (fs::is_directory(path, none)) {
    if (fs::exists(fs::path(path) / kMetadata, none)) return true;
    const auto entries = fs::directory_iterator(path, none);
    return std::any_of(begin(entries), end(entries),
                       [](const fs::directory_entry& e) { return is_part(e.path()); });
  }
  if (!fs::is_regular_file(path, none)) return false;
  try {
    std::string begin = begin_of(path);
    if (is_compressed(begin)) {
      std::string inside(16, '\0');
      inside.resize(UnpackedFile(path).read(inside.data(), inside.size()));
      begin = inside;
    }
    return begins_as_mcap(begin) || begins_as_sqlite(begin);
  } catch (const std::runtime_error&) {  // who reads it will say so
    return false;
  }
}

std::unique_ptr<BagMessages> open_bag(const std::string& path, const std::string& topic) {
  std::unique_ptr<BagMessages> bag;
  if (fs::is_directory(path)) {
    std::vector<std::string> parts = parts_of(path);
    if (parts.empty())
      throw std::runtime_error(path + ": is a folder without a file of a bag (.db3, .mcap)");
    bag = std::make_unique<FolderMessages>(std::move(parts));
  } else {
    bag = std::make_unique<PartMessages>(path);
  }
  bag->choose(path, topic);
  return bag;
}

}  // namespace tauext
