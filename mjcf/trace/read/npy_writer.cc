// SPDX-License-Identifier: Apache-2.0
#include "mjcf/trace/read/npy_writer.h"

#include <fmt/format.h>

#include <bit>
#include <cstdint>
#include <stdexcept>
#include <string_view>

#include "mjcf/trace/atomic_file.h"
#include "mjcf/trace/byte_order.h"
#include "mjcf/trace/read/text/unpacked_file.h"

namespace tauext {
namespace {

constexpr const char* kDouble = std::endian::native == std::endian::little ? "<f8" : ">f8";
constexpr std::uint64_t kMostZip = 0xFFFFFFFF;  // [bytes] beyond which a ZIP needs 64 bits
constexpr std::size_t kMostArrays = 65535;      // likewise

std::size_t width_of(const NpyArray& a) {
  return a.columns == 0 ? 1 : a.columns;
}

std::string_view bytes_of(const NpyArray& a) {
  return {reinterpret_cast<const char*>(a.data), a.rows * width_of(a) * sizeof(double)};
}

std::string header_of(const NpyArray& a) {
  std::string text =
      fmt::format("{{'descr': '{}', 'fortran_order': False, 'shape': ({},{}), }}", kDouble, a.rows,
                  a.columns > 0 ? fmt::format(" {}", a.columns) : "");
  // the elements begin at a multiple of 64 bytes
  constexpr std::size_t kBegin = 10, kAlign = 64;
  text.resize((kBegin + text.size() + kAlign) / kAlign * kAlign - kBegin, ' ');
  text.back() = '\n';
  return "\x93NUMPY" + to_bytes(1, 2) + to_bytes(text.size(), 2) + text;
}

// what is the same in the local header of a member and in the directory
struct Member {
  std::string name, header;
  std::uint64_t offset = 0, size = 0;  // [bytes]
  std::uint32_t crc = 0;

  std::string common() const {
    constexpr int kVersion = 20, kFlags = 0, kStored = 0, kTime = 0, kDay = 33;  // 1980-01-01
    return to_bytes(kVersion, 2) + to_bytes(kFlags, 2) + to_bytes(kStored, 2) + to_bytes(kTime, 2) +
           to_bytes(kDay, 2) + to_bytes(crc, 4) + to_bytes(size, 4) + to_bytes(size, 4) +
           to_bytes(name.size(), 2) + to_bytes(0, 2);
  }
  std::string local() const { return "PK\3\4" + common() + name + header; }
  std::string entry() const {
    constexpr std::uint64_t kUnix = 3, kMode = 0600;
    return "PK\1\2" + to_bytes(kUnix << 8 | 20, 2) + common() + to_bytes(0, 6) +
           to_bytes(kMode << 16, 4) + to_bytes(offset, 4) + name;
  }
};

// both throw before anything is written
void refuse_too_large(const std::string& path, const std::vector<NpyArray>& arrays) {
  double size = 0;  // [bytes], which a double holds whatever they are
  for (const NpyArray& a : arrays) {
    size += 8.0 * static_cast<double>(a.rows) * static_cast<double>(width_of(a)) +
            2.0 * static_cast<double>(a.name.size()) + 1000;
  }
  if (size < static_cast<double>(kMostZip) && arrays.size() <= kMostArrays) return;
  throw std::runtime_error(
      fmt::format("{}: a .npz of ours has at most 4 GiB and {} arrays: write a .mcap, or a .csv",
                  path, kMostArrays));
}

}  // namespace

void write_npz(const std::string& path, const std::vector<NpyArray>& arrays) {
  refuse_too_large(path, arrays);
  AtomicFile file(path);
  std::string directory;
  std::uint64_t at = 0;
  for (const NpyArray& a : arrays) {
    const std::string_view data = bytes_of(a);
    Member m{a.name + ".npy", header_of(a), at, 0, 0};
    m.size = m.header.size() + data.size();
    m.crc = crc32_of(crc32_of(0, m.header.data(), m.header.size()), data.data(), data.size());
    const std::string local = m.local();
    file.write(local);
    file.write(data);
    directory += m.entry();
    at += local.size() + data.size();
  }
  const std::string count = to_bytes(arrays.size(), 2);
  file.write(directory);
  file.write("PK\5\6" + to_bytes(0, 4) + count + count + to_bytes(directory.size(), 4) +
             to_bytes(at, 4) + to_bytes(0, 2));
  file.commit();
}

void write_npz(const std::string& path, const Trace& trace) {
  const auto samples = static_cast<std::size_t>(trace.size());
  const auto joints = static_cast<std::size_t>(trace.dof());
  std::vector<NpyArray> arrays{
      {"t", trace.t.data(), samples},
      {"q", trace.q.data(), samples, joints},
      {"qd", trace.qd.data(), samples, joints},
      {trace.torque_at_instants ? "tau_instant" : "tau", trace.tau.data(), samples, joints}};
  if (trace.has_truth()) arrays.push_back({"tau_ext", trace.tau_ext.data(), samples, joints});
  const std::vector<double> contact(trace.contact.begin(), trace.contact.end());
  if (!contact.empty()) arrays.push_back({"contact", contact.data(), samples});
  write_npz(path, arrays);
}

}  // namespace tauext
