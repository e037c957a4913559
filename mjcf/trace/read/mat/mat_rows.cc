// SPDX-License-Identifier: Apache-2.0
#include "mjcf/trace/read/mat/mat_rows.h"

#include <fmt/format.h>
#ifdef TAUEXT_MAT
#include <dlfcn.h>
#include <matio.h>
#ifdef TAUEXT_ZLIB
#include <zlib.h>
#endif
#endif

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <map>
#include <memory>
#include <new>
#include <set>
#include <stdexcept>
#include <utility>

#include "mjcf/trace/byte_order.h"
#include "mjcf/trace/child/confined.h"
#include "mjcf/trace/printable.h"
#include "mjcf/trace/read/numpy/npy_header.h"
#include "mjcf/trace/read/text/byte_file.h"

namespace tauext {

bool begins_as_mat(std::string_view begin) {
  return begin.starts_with("MATLAB 5.0 MAT-file") || begin.starts_with("MATLAB 7.3 MAT-file");
}

#ifdef TAUEXT_MAT
namespace detail {

// libmatio brings HDF5 and thirty libraries along, so it is loaded where a .mat is read
struct Matio {
  Matio() {
    void* const from = ::dlopen(TAUEXT_MAT, RTLD_NOW);
    if (from == nullptr)
      throw std::runtime_error(fmt::format(
          "libmatio, which reads MATLAB's files, cannot be loaded: {}; install Debian's libmatio",
          ::dlerror()));
    find(from, "Mat_Open", open), find(from, "Mat_Close", close);
    find(from, "Mat_VarReadNext", next), find(from, "Mat_VarFree", release);
    find(from, "Mat_VarGetNumberOfFields", field_count);
    find(from, "Mat_VarGetStructFieldnames", field_names);
    find(from, "Mat_VarGetStructFieldByIndex", field);
    find(from, "Mat_LogInitFunc", log);
  }

  decltype(&Mat_Open) open;
  decltype(&Mat_Close) close;
  decltype(&Mat_VarReadNext) next;
  decltype(&Mat_VarFree) release;
  decltype(&Mat_VarGetNumberOfFields) field_count;
  decltype(&Mat_VarGetStructFieldnames) field_names;
  decltype(&Mat_VarGetStructFieldByIndex) field;
  decltype(&Mat_LogInitFunc) log;

 private:
  template <class Pointer>
  static void find(void* from, const char* name, Pointer& pointer) {
    pointer = reinterpret_cast<Pointer>(::dlsym(from, name));
    if (pointer == nullptr) throw std::runtime_error(fmt::format("libmatio has no {}", name));
  }
};

// an array of real numbers
struct MatArray {
  std::string name;
  std::size_t rows = 0, columns = 0;
  std::vector<double> numbers;  // column by column

  std::size_t length() const { return std::max(rows, columns); }
  bool is_vector() const { return std::min(rows, columns) == 1; }
  bool is_time() const {
    const std::size_t dot = name.rfind('.');
    const std::string last = dot == name.npos ? name : name.substr(dot + 1);
    return is_vector() && (last == "t" || last == "time");
  }
};

template <class Number>
std::vector<double> numbers_of(const void* data, std::size_t count) {
  std::vector<double> all(count);
  for (std::size_t i = 0; i < count; ++i) {
    Number x{};
    std::memcpy(&x, static_cast<const char*>(data) + i * sizeof x, sizeof x);
    all[i] = static_cast<double>(x);
  }
  return all;
}

// what libmatio says is wrong: its first words
std::string& complaint() {
  static std::string words;
  return words;
}

// the variables of a file, and the fields in them
class MatFile {
 public:
  explicit MatFile(const std::string& path) {
    matio_.log("tauext", [](int level, char* words) {
      const bool bad =
          (level & (MATIO_LOG_LEVEL_ERROR | MATIO_LOG_LEVEL_CRITICAL | MATIO_LOG_LEVEL_WARNING)) !=
          0;
      if (bad && complaint().empty()) complaint() = words;
    });
    mat_t* const file = matio_.open(path.c_str(), MAT_ACC_RDONLY);
    if (file == nullptr) fail();
    while (matvar_t* const v = matio_.next(file)) {
      take(*v, v->name == nullptr ? "" : v->name, 0);
      matio_.release(v);
    }
    matio_.close(file);
    if (!complaint().empty()) fail();
  }

  std::vector<MatArray> arrays;
  std::vector<std::string> others;  // which are no arrays of real numbers

 private:
  [[noreturn]] static void fail() {
    const std::string& why = complaint();
    throw std::runtime_error("cannot be read by libmatio: " +
                             (why.empty() ? std::string("it is damaged") : one_line(why, 200)));
  }

  void take(const matvar_t& v, const std::string& name, int depth) {
    constexpr int kDeepest = 20;
    if (depth > kDeepest) throw std::runtime_error("has structures in structures without end");
    std::size_t count = 1;
    for (int i = 0; i < v.rank; ++i) {
      if (v.dims[i] != 0 && count > kMostNumbers / v.dims[i])
        throw std::runtime_error(fmt::format("'{}' is too large", printable_name(name)));
      count *= v.dims[i];
    }
    if (v.class_type == MAT_C_STRUCT) return take_fields(v, name, count, depth);
    if (v.class_type == MAT_C_CHAR || count <= 1) return;
    if (v.isComplex != 0 || !take_numbers(v, name, count)) others.push_back(name);
  }

  void take_fields(const matvar_t& v, const std::string& name, std::size_t count, int depth) {
    matvar_t* const structure = const_cast<matvar_t*>(&v);
    const unsigned fields = matio_.field_count(structure);
    char* const* const names = matio_.field_names(structure);
    for (std::size_t i = 0; i < count && v.data != nullptr && names != nullptr; ++i)
      for (unsigned f = 0; f < fields; ++f) {
        const matvar_t* const field = matio_.field(structure, f, i);
        const std::string of = count == 1 ? name : fmt::format("{}({})", name, i + 1);
        if (field != nullptr) take(*field, fmt::format("{}.{}", of, names[f]), depth + 1);
      }
  }

  bool take_numbers(const matvar_t& v, const std::string& name, std::size_t count) {
    struct Kind {
      matio_classes of;
      std::size_t size;  // [bytes]
      std::vector<double> (*numbers)(const void*, std::size_t);
    };
    constexpr Kind kKinds[] = {
        {MAT_C_DOUBLE, 8, numbers_of<double>},      {MAT_C_SINGLE, 4, numbers_of<float>},
        {MAT_C_INT8, 1, numbers_of<std::int8_t>},   {MAT_C_UINT8, 1, numbers_of<std::uint8_t>},
        {MAT_C_INT16, 2, numbers_of<std::int16_t>}, {MAT_C_UINT16, 2, numbers_of<std::uint16_t>},
        {MAT_C_INT32, 4, numbers_of<std::int32_t>}, {MAT_C_UINT32, 4, numbers_of<std::uint32_t>},
        {MAT_C_INT64, 8, numbers_of<std::int64_t>}, {MAT_C_UINT64, 8, numbers_of<std::uint64_t>}};
    const auto kind = std::find_if(std::begin(kKinds), std::end(kKinds),
                                   [&](const Kind& k) { return k.of == v.class_type; });
    std::vector<std::size_t> shape(v.dims, v.dims + v.rank);
    if (shape.size() > 2) std::erase(shape, std::size_t{1});
    if (shape.size() == 1) shape.push_back(1);
    if (kind == std::end(kKinds) || shape.size() != 2) return false;
    if (v.data == nullptr || v.nbytes < count * kind->size)
      throw std::runtime_error(fmt::format("'{}' is damaged", printable_name(name)));
    arrays.push_back({name, shape[0], shape[1], kind->numbers(v.data, count)});
    return true;
  }

  static constexpr std::size_t kMostNumbers = std::size_t{1} << 28;

  Matio matio_;
};

// how many rows there are
std::size_t rows_in(const std::vector<MatArray>& arrays) {
  const MatArray* t = nullptr;
  std::map<std::size_t, std::size_t> times;  // by length
  for (const MatArray& a : arrays) {
    ++times[a.length()];
    if (!a.is_time()) continue;
    if (t != nullptr && t->length() != a.length())
      throw std::runtime_error(
          fmt::format("has {} of {} rows and {} of {}: save one of these recordings alone",
                      printable_name(t->name), t->length(), printable_name(a.name), a.length()));
    t = &a;
  }
  if (t != nullptr) return t->length();
  if (times.empty()) throw std::runtime_error("has no array that could be columns");
  return std::max_element(times.rbegin(), times.rend(),
                          [](const auto& a, const auto& b) { return a.second < b.second; })
      ->first;
}

// the parts of the child's answer
void put(std::string& to, std::size_t n) {
  to += to_bytes(n, sizeof n);
}
void put(std::string& to, const std::string& text) {
  put(to, text.size());
  to += text;
}
// a child that a file has damaged may answer anything
void require(bool whole) {
  if (!whole) throw std::runtime_error("libmatio's answer is not whole");
}
std::size_t taken_count(std::string_view& from) {
  require(from.size() >= sizeof(std::size_t));
  const std::size_t n = from_bytes(from.data(), sizeof n);
  from.remove_prefix(sizeof n);
  return n;
}
std::string taken_text(std::string_view& from) {
  const std::size_t size = taken_count(from);
  require(size <= from.size());
  std::string text(from.substr(0, size));
  from.remove_prefix(size);
  return text;
}

#ifdef TAUEXT_ZLIB

// Of a compressed variable of version 5, which libmatio unpacks only as far as it needs to, and so
// without its checksum.
void compare_checksum(const ByteFile& file, std::uint64_t at, std::uint64_t size) {
  constexpr std::size_t kBlock = 1 << 16;  // [bytes]
  std::vector<unsigned char> packed(kBlock), made(4 * kBlock);
  z_stream z{};
  if (::inflateInit(&z) != Z_OK) throw std::bad_alloc();
  const std::unique_ptr<z_stream, int (*)(z_stream*)> end(&z, ::inflateEnd);
  int code = Z_OK;
  while (code == Z_OK && (size > 0 || z.avail_in > 0 || z.avail_out == 0)) {
    if (z.avail_in == 0 && size > 0) {
      const std::uint64_t some = std::min<std::uint64_t>(size, kBlock);
      file.read(at, packed.data(), static_cast<std::size_t>(some));
      at += some, size -= some;
      z.next_in = packed.data(), z.avail_in = static_cast<uInt>(some);
    }
    z.next_out = made.data(), z.avail_out = static_cast<uInt>(made.size());
    code = ::inflate(&z, Z_NO_FLUSH);
  }
  if (code != Z_STREAM_END) file.fail("is damaged: a variable is not what its checksum says");
}

#else

void compare_checksum(const ByteFile&, std::uint64_t, std::uint64_t) {}

#endif

// of version 5: "MAT-File Format", 1-4
void refuse_damage(const ByteFile& file) {
  constexpr std::uint64_t kHead = 128, kTag = 8;  // [bytes]
  constexpr std::uint64_t kMatrix = 14, kCompressed = 15;
  std::array<unsigned char, kHead> head{};
  if (!file.has(0, kHead)) file.fail("is cut off");
  file.read(0, head.data(), kHead);
  const std::endian order = head[126] == 'M' ? std::endian::big : std::endian::little;
  if (from_bytes(head.data() + 124, 2, order) >> 8 != 1) return;  // HDF5, which looks for itself
  for (std::uint64_t at = kHead; at < file.size();) {
    std::array<unsigned char, kTag> tag{};
    if (!file.has(at, kTag)) file.fail("is cut off");
    file.read(at, tag.data(), kTag);
    const std::uint64_t size = from_bytes(tag.data() + 4, 4, order);
    if (!file.has(at + kTag, size)) file.fail("is cut off");
    const std::uint64_t kind = from_bytes(tag.data(), 4, order);
    if (kind != kMatrix && kind != kCompressed) file.fail("is damaged: it has more than variables");
    if (kind == kCompressed) compare_checksum(file, at + kTag, size);
    at += kTag + size;
  }
}

// in the child: what could not be used, the columns' names, and their numbers, row by row
std::string table_of(const std::string& path) {
  MatFile file(path);
  const std::size_t n = rows_in(file.arrays);
  std::vector<std::pair<std::string, const double*>> columns;
  std::vector<std::size_t> strides;
  for (const MatArray& a : file.arrays) {
    const bool upright = a.rows == n;
    const std::size_t width = upright ? a.columns : a.rows;
    if (!upright && a.columns != n) {
      file.others.push_back(fmt::format("{} ({} x {})", a.name, a.rows, a.columns));
      continue;
    }
    for (std::size_t j = 0; j < width; ++j) {
      columns.emplace_back(a.is_vector() ? a.name : fmt::format("{}{}", a.name, j + 1),
                           a.numbers.data() + (upright ? j * n : j));
      strides.push_back(upright ? 1 : width);
    }
  }
  if (columns.size() > kMostNpyColumns)
    throw std::runtime_error(fmt::format("has more than {} columns", kMostNpyColumns));
  std::string all, others;
  for (const std::string& o : file.others)
    others += (others.empty() ? "" : ", ") + printable_name(o);
  put(all, others);
  put(all, columns.size());
  std::set<std::string> known;
  for (const auto& [name, at] : columns) {
    if (!known.insert(name).second)
      throw std::runtime_error(fmt::format("column '{}' appears twice", printable_name(name)));
    put(all, name);
  }
  all.reserve(all.size() + n * columns.size() * sizeof(double));
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < columns.size(); ++j)
      all.append(reinterpret_cast<const char*>(columns[j].second + i * strides[j]), sizeof(double));
  return all;
}

}  // namespace detail

MatRows::MatRows(const std::string& path) {
  constexpr std::size_t kGigabyte = std::size_t{1} << 30;
  const ByteFile file(path);
  detail::refuse_damage(file);
  try {
    const std::string all =
        confined({.time = 300, .memory = 8 * kGigabyte, .result = 2 * kGigabyte},
                 [&] { return detail::table_of(path); });
    std::string_view rest = all;
    note_ = detail::taken_text(rest);
    const std::size_t columns = detail::taken_count(rest);
    detail::require(columns <= rest.size() / sizeof columns);
    columns_.resize(columns);
    for (std::string& name : columns_) name = detail::taken_text(rest);
    numbers_.resize(rest.size() / sizeof(double));
    detail::require(numbers_.size() * sizeof(double) == rest.size() &&
                    (numbers_.empty() || (columns > 0 && numbers_.size() % columns == 0)));
    std::memcpy(numbers_.data(), rest.data(), rest.size());
  } catch (const Unfinished& e) {
    file.fail(fmt::format("libmatio {} when it reads this file", e.what()));
  } catch (const std::runtime_error& e) {
    file.fail(e.what());
  }
}

#else

MatRows::MatRows(const std::string& path) {
  throw std::runtime_error(path +
                           ": MATLAB's files are left out of this build: install Debian's "
                           "libmatio-dev, and build again");
}

#endif

bool MatRows::next(std::vector<double>& row, SkippedRows& skipped) {
  if (!note_.empty())
    skipped.notes.push_back("left out, being no real numbers in as many rows: " + note_);
  note_.clear();
  const std::size_t begin = row_ * columns_.size();
  if (begin >= numbers_.size()) return false;
  row.assign(numbers_.begin() + static_cast<std::ptrdiff_t>(begin),
             numbers_.begin() + static_cast<std::ptrdiff_t>(begin + columns_.size()));
  ++row_;
  return true;
}

}  // namespace tauext
