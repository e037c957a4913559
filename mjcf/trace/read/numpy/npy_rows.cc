// SPDX-License-Identifier: Apache-2.0
#include "mjcf/trace/read/numpy/npy_rows.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <string_view>

#include "mjcf/trace/printable.h"
#include "mjcf/trace/read/numpy/array_reader.h"

namespace tauext {
namespace {

bool begins_with(const ByteFile& file, std::string_view magic) {
  std::string begin(magic.size(), '\0');
  if (!file.has(0, begin.size())) return false;
  file.read(0, begin.data(), begin.size());
  return begin == magic;
}

// nothing of metadata
std::unique_ptr<ArrayReader> open_array(const ByteFile& file, const Extent& extent,
                                        const std::string& name) {
  ByteStream stream(file, extent, false);
  const NpyHeader header = read_npy_header(stream);
  if (!name.empty() && is_metadata(header)) return nullptr;
  return std::make_unique<ArrayReader>(file, extent, header, name);
}

}  // namespace

NpyRows::NpyRows(const std::string& path) : file_(std::make_unique<ByteFile>(path)) {
  if (begins_with(*file_, "\x93NUMPY")) {
    arrays_.push_back(open_array(*file_, extent_of(*file_), ""));
  } else if (begins_with(*file_, "PK")) {
    require_zlib();
    add_members();
  } else {
    file_->fail(file_->size() == 0 ? "is empty" : "begins as neither a .npy nor a .npz does");
  }
  refuse_other_lengths();
  take_columns();
}

NpyRows::~NpyRows() = default;

void NpyRows::add_members() {
  constexpr std::string_view kEnd = ".npy";
  std::size_t lanes = 0;
  for (const ZipMember& m : zip_members(*file_)) {
    if (!std::string_view(m.name).ends_with(kEnd)) continue;
    const std::string name = m.name.substr(0, m.name.size() - kEnd.size());
    const std::string what = fmt::format("{}: array '{}'", file_->path(), printable_name(name));
    auto array = open_array(*file_, extent_of(*file_, m, what), name);
    if (array == nullptr) continue;
    lanes += array->lanes();
    if (lanes > kMostNpyLanes) {
      file_->fail(
          fmt::format("has more than {} arrays, or columns in Fortran order", kMostNpyLanes));
    }
    arrays_.push_back(std::move(array));
  }
  if (arrays_.empty()) file_->fail("has no array that could be columns");
}

void NpyRows::refuse_other_lengths() {
  const auto t =
      std::find_if(arrays_.begin(), arrays_.end(), [](const auto& a) { return a->name() == "t"; });
  const ArrayReader& first = t == arrays_.end() ? *arrays_[0] : **t;
  rows_ = first.rows();
  std::string others;
  for (const auto& a : arrays_) {
    if (a->rows() == rows_) continue;
    others += fmt::format("{} '{}' ({})", others.empty() ? "" : ",", printable_name(a->name()),
                          a->rows());
  }
  if (others.empty()) return;
  file_->fail(one_line(fmt::format("arrays that have not as many rows as '{}' ({}):{}",
                                   printable_name(first.name()), rows_, others)));
}

void NpyRows::take_columns() {
  std::set<std::string> known;
  for (const auto& a : arrays_) {
    for (const std::string& c : a->columns()) {
      if (!known.insert(c).second) {
        file_->fail(fmt::format("column '{}' appears twice", printable_name(c)));
      }
      columns_.push_back(c);
    }
    if (columns_.size() > kMostNpyColumns) {
      file_->fail(fmt::format("has more than {} columns", kMostNpyColumns));
    }
  }
}

bool NpyRows::next(std::vector<double>& row, SkippedRows&) {
  if (row_ == rows_) return false;
  row.resize(columns_.size());
  double* at = row.data();
  for (const auto& a : arrays_) {
    a->next(at);
    at += a->columns().size();
  }
  ++row_;
  return true;
}

}  // namespace tauext
