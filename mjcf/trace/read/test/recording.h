// SPDX-License-Identifier: Apache-2.0
// Files for the tests of readers, and all rows of one.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "mjcf/test/error_of.h"
#include "mjcf/trace/input_file.h"
#include "mjcf/trace/read/row_source.h"

namespace tauext::test {

using Rows = std::vector<std::vector<double>>;

inline Rows rows_of(RowSource& source, SkippedRows& skipped) {
  skipped.unit = source.unit();
  Rows rows;
  std::vector<double> row;
  while (source.next(row, skipped)) rows.push_back(row);
  EXPECT_FALSE(source.next(row, skipped));
  return rows;
}

inline Rows rows_of(RowSource&& source) {
  SkippedRows skipped;
  return rows_of(source, skipped);
}

// so many bytes of a number, the lowest first
inline std::string low_first(unsigned long long number, int count) {
  std::string s;
  for (; count > 0; --count, number >>= 8) s += static_cast<char>(number & 255);
  return s;
}

// bytes written as hexadecimal digits
inline std::string bytes_of_hex(const std::string& text) {
  std::istringstream in(text);
  std::string bytes;
  for (unsigned byte; in >> std::hex >> byte;) bytes += static_cast<char>(byte);
  return bytes;
}

class Recording : public testing::Test {
 protected:
  Recording()
      : folder_(std::filesystem::temp_directory_path() /
                ("tauext_read_" + std::to_string(::getpid()))) {
    std::filesystem::create_directories(folder_);
  }
  ~Recording() override { std::filesystem::remove_all(folder_); }

  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  // a new file each time, as some file systems wait for the disk where an old one is shortened
  std::string put(const std::string& bytes, const std::string& name) const {
    release_input(path(name));
    std::filesystem::remove(path(name));
    std::ofstream(path(name), std::ios::binary) << bytes;
    return path(name);
  }
  static std::string get(const std::string& file) {
    std::ostringstream out;
    out << std::ifstream(file, std::ios::binary).rdbuf();
    return out.str();
  }
  static std::string fixture(const std::string& name) { return "mjcf/trace/read/test/" + name; }
  // what reading each beginning of a file does, which must not be to end the program
  template <class Source>
  int beginnings_that_can_be_read(const std::string& bytes) const {
    int readable = 0;
    for (std::size_t n = 0; n < bytes.size(); ++n) {
      const std::string file = put(bytes.substr(0, n), "beginning");
      const std::string error = error_of([&] { rows_of(Source(file)); });
      const bool read = error == "no error";
      readable += read ? 1 : 0;
      EXPECT_TRUE(read || error.starts_with(file + ": ")) << error;
    }
    return readable;
  }

  std::filesystem::path folder_;
};

}  // namespace tauext::test
