// SPDX-License-Identifier: Apache-2.0
#include "mjcf/trace/read/numpy/array_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "mjcf/trace/printable.h"

namespace tauext {
namespace {

bool has_numbers(const NpyHeader& h) {
  return std::any_of(h.fields.begin(), h.fields.end(),
                     [](const NpyField& f) { return f.is_number; });
}

std::uint64_t width_of(const NpyHeader& h) {
  return h.shape.size() == 2 ? h.shape[1] : 1;
}

// why these are no rows of numbers; "" if they are
std::string objection(const NpyHeader& h) {
  if (h.unusable == "|O") {
    return "holds Python objects, which are not read: save numbers (dtype=float)";
  }
  if (!h.unusable.empty()) {
    return fmt::format("holds '{}', which is no plain number", printable_name(h.unusable));
  }
  if (!has_numbers(h)) return "holds no numbers";
  const std::size_t most = h.structured ? 1 : 2, dimensions = h.shape.size();
  if (dimensions == 0 || dimensions > most) {
    return fmt::format("has {} dimensions, where rows of {} have 1{}", dimensions,
                       h.structured ? "fields" : "numbers", most == 1 ? "" : " or 2");
  }
  if (width_of(h) == 0 || width_of(h) > kMostNpyColumns) {
    return fmt::format("has {} columns, where 1 to {} can be read", width_of(h), kMostNpyColumns);
  }
  return "";
}

}  // namespace

bool is_metadata(const NpyHeader& h) {
  return h.shape.empty() || (h.unusable.empty() && !has_numbers(h));
}

ArrayReader::ArrayReader(const ByteFile& file, const Extent& extent, const NpyHeader& h,
                         const std::string& name)
    : name_(name) {
  const std::string why = objection(h);
  if (!why.empty()) throw std::runtime_error(fmt::format("{}: {}", extent.what, why));
  rows_ = h.shape[0];
  name_columns(h);
  const auto width = static_cast<std::size_t>(width_of(h));
  check_size(extent, h, width * h.item_size);
  bytes_.resize(width * h.item_size);
  std::vector<Cell> cells;
  for (const NpyField& f : h.fields) {
    if (!f.is_number) continue;
    for (std::size_t i = 0; i < f.count; ++i) {
      cells.push_back({f.number, f.offset + i * static_cast<std::size_t>(f.number.size)});
    }
  }
  if (h.fortran_order && width > 1) {
    for (std::size_t j = 0; j < width; ++j) {
      add_lane(file, extent, h.size + j * rows_ * h.item_size, j + 1 == width, h.item_size, cells);
    }
    return;
  }
  for (std::size_t j = 1; j < width; ++j) cells.push_back({cells[0].number, j * h.item_size});
  add_lane(file, extent, h.size, true, width * h.item_size, std::move(cells));
}

void ArrayReader::name_columns(const NpyHeader& h) {
  for (const NpyField& f : h.fields) {
    if (!f.is_number) continue;
    const std::string& begin = h.structured ? f.name : name_;
    const bool numbered = h.structured ? f.count > 1 : h.shape.size() == 2;
    const std::size_t count = h.structured ? f.count : width_of(h);
    for (std::size_t i = 1; i <= count; ++i) {
      columns_.push_back(numbered || begin.empty() ? fmt::format("{}{}", begin, i) : begin);
    }
  }
}

void ArrayReader::check_size(const Extent& e, const NpyHeader& h, std::size_t row_size) const {
  const std::uint64_t there = e.size - h.size, claimed = rows_ * row_size;
  const auto fail = [&](const std::string& why) {
    throw std::runtime_error(fmt::format("{}: {}", e.what, why));
  };
  if (there < claimed) fail(fmt::format("is cut off: {} of {} bytes", there, claimed));
  if (there > claimed) {
    fail(fmt::format("has {} bytes more than its {} rows", there - claimed, rows_));
  }
  if (h.fortran_order && width_of(h) > kMostNpyLanes) {
    fail(
        fmt::format("has {} columns in Fortran order, of at most {}: save "
                    "numpy.ascontiguousarray of it",
                    width_of(h), kMostNpyLanes));
  }
}

void ArrayReader::add_lane(const ByteFile& file, const Extent& extent, std::uint64_t at,
                           bool checked, std::size_t row_size, std::vector<Cell> cells) {
  lanes_.push_back({ByteStream(file, extent, checked), std::move(cells), row_size});
  lanes_.back().stream.skip(at);
}

void ArrayReader::next(double* row) {
  for (Lane& lane : lanes_) {
    lane.stream.read(bytes_.data(), lane.row_size);
    for (const Cell& cell : lane.cells) *row++ = cell.number.value(&bytes_[cell.offset]);
  }
}

}  // namespace tauext
