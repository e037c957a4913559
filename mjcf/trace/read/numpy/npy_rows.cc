// SPDX-License-Identifier: Apache-2.0
#include "mjcf/trace/read/numpy/npy_rows.h"

#include <fmt/format.h>
#ifdef TAUEXT_ARCHIVE
#include <archive.h>
#include <archive_entry.h>
#endif

#include <algorithm>
#include <cstdint>
#include <functional>
#include <memory>
#include <new>
#include <set>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "mjcf/trace/input_file.h"
#include "mjcf/trace/printable.h"

namespace tauext {
namespace {

constexpr std::string_view kArray = "\x93NUMPY", kZip = "PK";

[[noreturn]] void refuse(const std::string& what, const std::string& why) {
  throw std::runtime_error(fmt::format("{}: {}", what, one_line(why)));
}

std::uint64_t width_of(const NpyHeader& h) {
  return h.shape.size() == 2 ? h.shape[1] : 1;
}

bool has_numbers(const NpyHeader& h) {
  return std::any_of(h.fields.begin(), h.fields.end(),
                     [](const NpyField& f) { return f.is_number; });
}

// a number without a dimension, or text
bool is_metadata(const NpyHeader& h) {
  return h.shape.empty() || (h.unusable.empty() && !has_numbers(h));
}

// why these are no rows of numbers; "" if they are
std::string objection(const NpyHeader& h) {
  if (h.unusable == "|O")
    return "holds Python objects, which are not read: save numbers (dtype=float)";
  if (h.unusable.starts_with("<M8") || h.unusable.starts_with("<m8"))
    return fmt::format("holds '{}', which are no seconds: (t - t[0]) / np.timedelta64(1, 's') are",
                       printable_name(h.unusable));
  if (!h.unusable.empty())
    return fmt::format("holds '{}', which is no plain number", printable_name(h.unusable));
  if (!has_numbers(h)) return "holds no numbers";
  const std::size_t most = h.structured ? 1 : 2, dimensions = h.shape.size();
  if (dimensions == 0 || dimensions > most)
    return fmt::format("has {} dimensions, where rows of {} have 1{}", dimensions,
                       h.structured ? "fields" : "numbers", most == 1 ? "" : " or 2");
  if (width_of(h) == 0 || width_of(h) > kMostNpyColumns)
    return fmt::format("has {} columns, where 1 to {} can be read", width_of(h), kMostNpyColumns);
  return "";
}

#ifdef TAUEXT_ARCHIVE

using Found = std::function<void(const std::string& name, std::string bytes)>;

// the members of a ZIP that are arrays; libarchive compares their checksums
class Zip {
 public:
  // the bytes must outlive it
  Zip(const std::string& path, const std::string& bytes)
      : path_(path), zip_(archive_read_new(), archive_read_free) {
    if (!zip_) throw std::bad_alloc();
    require(path_, archive_read_support_format_zip_seekable(zip_.get()));
    if (archive_read_open_memory(zip_.get(), bytes.data(), bytes.size()) != ARCHIVE_OK)
      refuse(
          path_,
          "lacks the list of its arrays, which stands at its end: was it cut off? Copy it again");
  }

  void each(const Found& found) {
    constexpr std::string_view kEnd = ".npy";
    for (archive_entry* entry = nullptr;;) {
      const int code = archive_read_next_header(zip_.get(), &entry);
      if (code == ARCHIVE_EOF) return;
      if (code != ARCHIVE_WARN) require(path_, code);  // of letters that the locale lacks
      const char* text = archive_entry_pathname_utf8(entry);
      if (text == nullptr) text = archive_entry_pathname(entry);
      const std::string name = text == nullptr ? "" : text;
      if (!name.ends_with(kEnd))
        refuse(path_, fmt::format("has '{}', which is no array of NumPy: unzip it first",
                                  printable_name(name)));
      const std::string array = name.substr(0, name.size() - kEnd.size());
      found(array, bytes_of(fmt::format("{}: array '{}'", path_, printable_name(array))));
    }
  }

 private:
  std::string bytes_of(const std::string& what) {
    constexpr std::size_t kMost = std::size_t{1} << 31;  // [bytes] of all
    std::string bytes;
    for (;;) {
      const void* block = nullptr;
      std::size_t size = 0;
      la_int64_t at = 0;
      const int code = archive_read_data_block(zip_.get(), &block, &size, &at);
      if (code == ARCHIVE_EOF) return bytes;
      require(what, code);
      if ((unpacked_ += size) > kMost)
        refuse(path_, "has more than 2 GiB unpacked: save a .npy, or several files (`parts`)");
      bytes.append(static_cast<const char*>(block), size);
    }
  }

  void require(const std::string& what, int code) const {
    if (code == ARCHIVE_OK) return;
    const char* const why = archive_error_string(zip_.get());
    refuse(what, fmt::format("cannot be unpacked: {}", why == nullptr ? "it is damaged" : why));
  }

  std::string path_;
  std::unique_ptr<archive, int (*)(archive*)> zip_;
  std::size_t unpacked_ = 0;  // [bytes]
};

#else

class Zip {
 public:
  Zip(const std::string& path, const std::string&) {
    refuse(
        path,
        "what reads a .npz is left out of this build: install Debian's libarchive-dev, and build "
        "again");
  }
  template <class Found>
  void each(Found&&) {}
};

#endif

}  // namespace

NpyRows::NpyRows(const std::string& path) {
  std::string bytes = read_whole(path, std::size_t{1} << 32);
  if (bytes.starts_with(kArray)) {
    add(path, "", std::move(bytes));
  } else if (bytes.starts_with(kZip)) {
    Zip(path, bytes).each([&](const std::string& name, std::string array) {
      add(fmt::format("{}: array '{}'", path, printable_name(name)), name, std::move(array));
    });
    if (arrays_.empty()) refuse(path, "has no array that could be columns");
  } else {
    refuse(path, bytes.empty() ? "is empty" : "begins as neither a .npy nor a .npz does");
  }
  require_equal_lengths(path);
  require_different_columns(path);
}

void NpyRows::add(const std::string& what, std::string name, std::string bytes) {
  const NpyHeader h = read_npy_header(bytes, what);
  if (!name.empty() && is_metadata(h)) return;
  if (const std::string why = objection(h); !why.empty()) refuse(what, why);
  const auto width = static_cast<std::size_t>(width_of(h));
  const std::uint64_t there = bytes.size() - h.size, claimed = h.shape[0] * width * h.item_size;
  if (there < claimed) refuse(what, fmt::format("is cut off: {} of {} bytes", there, claimed));
  if (there > claimed)
    refuse(what, fmt::format("has {} bytes more than its {} rows", there - claimed, h.shape[0]));
  Array a{std::move(name), std::move(bytes), static_cast<std::size_t>(h.shape[0]), {}};
  const std::size_t along = h.fortran_order ? a.rows * h.item_size : h.item_size,
                    down = h.fortran_order ? h.item_size : width * h.item_size;
  // of shape (n, 1), too
  const bool is_one = width == 1 && (a.name == "t" || a.name == "contact");
  for (const NpyField& f : h.fields) {
    if (!f.is_number) continue;
    const std::string& begin = h.structured ? f.name : a.name;
    const bool numbered = h.structured ? f.count > 1 : h.shape.size() == 2 && !is_one;
    const std::size_t count = h.structured ? f.count : width;
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t size = static_cast<std::size_t>(f.number.size);
      a.cells.push_back({f.number, h.size + f.offset + i * (h.structured ? size : along), down});
      columns_.push_back(numbered || begin.empty() ? fmt::format("{}{}", begin, i + 1) : begin);
    }
  }
  if (columns_.size() > kMostNpyColumns)
    refuse(what, fmt::format("is one too many: there are more than {} columns", kMostNpyColumns));
  arrays_.push_back(std::move(a));
}

void NpyRows::require_equal_lengths(const std::string& path) {
  const auto t =
      std::find_if(arrays_.begin(), arrays_.end(), [](const Array& a) { return a.name == "t"; });
  const Array& first = t == arrays_.end() ? arrays_[0] : *t;
  rows_ = first.rows;
  std::string others;
  for (const Array& a : arrays_)
    if (a.rows != rows_)
      others +=
          fmt::format("{} '{}' ({})", others.empty() ? "" : ",", printable_name(a.name), a.rows);
  if (!others.empty())
    refuse(path, fmt::format("arrays that have not as many rows as '{}' ({}):{}",
                             printable_name(first.name), rows_, others));
}

void NpyRows::require_different_columns(const std::string& path) const {
  std::set<std::string> known;
  for (const std::string& c : columns_)
    if (!known.insert(c).second)
      refuse(path, fmt::format("column '{}' appears twice: save one of them by another name",
                               printable_name(c)));
}

bool NpyRows::next(std::vector<double>& row, SkippedRows&) {
  if (row_ == rows_) return false;
  row.clear();
  for (const Array& a : arrays_) {
    const auto* const bytes = reinterpret_cast<const unsigned char*>(a.bytes.data());
    for (const Cell& c : a.cells) row.push_back(c.number.value(bytes + c.at + row_ * c.stride));
  }
  ++row_;
  return true;
}

}  // namespace tauext
