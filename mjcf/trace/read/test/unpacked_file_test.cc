// SPDX-License-Identifier: Apache-2.0
// Compressed text, as the programs of the same names write it; and files that are no recordings.
#include "mjcf/trace/read/text/unpacked_file.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <map>
#include <string>
#include <utility>

#include "mjcf/trace/read/recording.h"
#include "mjcf/trace/read/test/recording.h"

namespace tauext::test {
namespace {

using namespace std::string_literals;

// of "t,q1,qd1,tau1\n0,1,2,3\n0.001,1,2,4\n0.002,1,2,5\n"
constexpr std::pair<const char*, const char*> kPacked[] = {
    {"gz",
     "1f 8b 08 00 00 00 00 00 02 03 2b d1 29 34 d4 29 4c 31 d4 29 49 2c 35 e4 32 d0 31 d4 31 d2 31 "
     "e6 32 d0 33 30 30 04 b3 4d c0 6c 23 30 db 94 0b 00 6f 93 c3 ce 2e 00 00 00"},
    {"xz",
     "fd 37 7a 58 5a 00 00 01 69 22 de 36 02 00 21 01 1c 00 00 00 10 cf 58 cc e0 00 2d 00 26 5d 00 "
     "3a 0b 0a 23 4a c7 80 a7 6c fd b6 2f 2d 14 70 34 d3 be ee 2d b7 53 d2 a7 06 8c 1c c8 b4 c5 1c "
     "43 cf 5a cd 9f 36 c0 00 00 00 6f 93 c3 ce 00 01 3e 2e 99 a3 95 bd 90 42 99 0d 01 00 00 00 00 "
     "01 59 5a"},
    {"bz2",
     "42 5a 68 39 31 41 59 26 53 59 cf 9b 40 03 00 00 15 d9 80 00 10 00 05 7e 00 24 00 26 00 20 00 "
     "31 00 00 06 21 47 90 7a 95 fd e5 d6 22 8f 60 48 b3 a1 01 ad 96 e6 41 ca 81 69 f8 5d c9 14 e1 "
     "42 43 3e 6d 00 0c"},
    {"zst",
     "28 b5 2f fd 24 2e 35 01 00 e2 82 08 0c d0 3d d8 22 00 c9 15 92 dd 54 ae 03 60 1e 8b e7 8f 43 "
     "79 2c 96 3f 0e e4 b1 f8 20 7b 6a c1 b4 a4 35 00 d5 86 c6 9a"},
    {"lz4",
     "04 22 4d 18 64 40 a7 2c 00 00 00 f1 0c 74 2c 71 31 2c 71 64 31 2c 74 61 75 31 0a 30 2c 31 2c "
     "32 2c 33 0a 30 2e 30 30 31 0c 00 11 34 0c 00 80 32 2c 31 2c 32 2c 35 0a 00 00 00 00 4c f6 45 "
     "97"},
};

class Unpacked : public Recording {
 protected:
  std::string error_of_opening(const std::string& bytes, const std::string& name) const {
    const std::string file = put(bytes, name);
    const std::string error = error_of([&] { open_rows(file); });
    EXPECT_TRUE(error.starts_with(file + ": ")) << error;
    return error;
  }
};

TEST_F(Unpacked, ATextIsTheSameWhateverItsNameIs) {
  for (const auto& [kind, hex] : kPacked) {
    const Rows rows = rows_of(std::move(*open_rows(put(bytes_of_hex(hex), "a.csv"))));
    EXPECT_EQ(rows, (Rows{{0, 1, 2, 3}, {0.001, 1, 2, 4}, {0.002, 1, 2, 5}})) << kind;
  }
}

// a file that ends early; and for kinds that have a checksum, a wrong number in it
TEST_F(Unpacked, DamageIsAnErrorThatNamesTheFileAndWhatSavesTheRest) {
  const std::map<std::string, std::string> programs = {
      {"gz", "gzip"}, {"xz", "xz"}, {"bz2", "bzip2"}, {"zst", "zstd"}, {"lz4", "lz4"}};
  for (const auto& [kind, hex] : kPacked) {
    const std::string bytes = bytes_of_hex(hex);
    const std::string cut = put(bytes.substr(0, bytes.size() / 2), "cut.csv."s + kind);
    const std::string error = error_of([&] { rows_of(std::move(*open_rows(cut))); });
    EXPECT_TRUE(error.starts_with(cut + ": cannot be unpacked: ")) << kind << ": " << error;
    EXPECT_TRUE(error.ends_with(
        fmt::format("; {} -dc {} > part.csv gets what is before that", programs.at(kind), cut)))
        << kind << ": " << error;
    if (kind == "gz"s || kind == "xz"s) {
      std::string wrong = bytes;
      wrong[kind == "gz"s ? wrong.size() - 8 : wrong.size() - 30] ^= 1;
      const std::string file = put(wrong, "wrong.csv");
      EXPECT_NE(error_of([&] { rows_of(std::move(*open_rows(file))); }), "no error") << kind;
    }
  }
}

TEST_F(Unpacked, WhatIsNotReadIsNamedWithARemedy) {
  for (const auto& [bytes, words] : std::vector<std::pair<std::string, std::string>>{
           {"#ROSBAG V2.0\n", "a bag of ROS 1, which is not read: rosbags-convert --src "},
           {"\x89HDF\r\n\x1a\n", "h5py"},
           {"PAR1\x15\x04", "pandas.read_parquet"},
           {"PK\x03\x04\x14\0\x06\0\x08\0\0\0!\0[Content_Types].xml"s,
            "x.csv').to_csv('run.csv', index=False)\""},
           {"\xff\xfet\0,\0q\0"s, "text in UTF-16, which is not read: iconv "},
           {"t\0,\0q\0"s, "text in UTF-16, which is not read: iconv -f UTF-16LE -t UTF-8 "},
           {"\0t\0,\0q"s, "text in UTF-16, which is not read: iconv -f UTF-16BE -t UTF-8 "},
           {"version https://git-lfs.github.com/spec/v1\noid sha256:4d7a\nsize 12345\n",
            "a pointer of Git LFS in the place of its data, which is not read: git lfs pull"},
           {"\xd0\xcf\x11\xe0", "python3 -c \"import pandas; pandas.read_excel('"},
           {"\x7f"
            "ELF\2\1\1\0"s,
            "unknown format of recording; known: CSV"}}) {
    const std::string error = error_of_opening(bytes, "x.csv");
    EXPECT_NE(error.find(words), std::string::npos) << error;
    for (const char c : error) EXPECT_TRUE(c >= ' ' && c <= '~') << error;
  }
}

}  // namespace
}  // namespace tauext::test
