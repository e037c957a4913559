// SPDX-License-Identifier: Apache-2.0
#include "mjcf/trace/input_file.h"

#include <fmt/format.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>
#include <stdexcept>

#include "mjcf/trace/file_claims.h"

namespace tauext {
namespace {

// whether JSON's brackets nest deeper, strings aside; text that is no JSON may be misjudged, and
// is refused by the parser
bool nests_deeper(const std::string& text, int most) {
  int depth = 0;
  bool in_string = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (in_string && c == '\\') {
      ++i;
    } else if (c == '"') {
      in_string = !in_string;
    } else if (!in_string && (c == '[' || c == '{')) {
      if (++depth > most) return true;
    } else if (!in_string && (c == ']' || c == '}')) {
      --depth;
    }
  }
  return false;
}

}  // namespace

void claim_input(const std::string& path) {
  struct stat file {};
  if (::stat(path.c_str(), &file) != 0 || ::access(path.c_str(), R_OK) != 0) {
    throw std::runtime_error(fmt::format("{}: {}", path, std::strerror(errno)));
  }
  if (S_ISREG(file.st_mode)) claims::add_input(file, path);
}

void refuse_input(const std::string& path) {
  struct stat file {};
  if (::stat(path.c_str(), &file) != 0 || !S_ISREG(file.st_mode)) return;
  claims::add_output(file, path);
  claims::drop_output(file);
}

void release_input(const std::string& path) {
  struct stat file {};
  if (::stat(path.c_str(), &file) == 0) claims::drop_input(file);
}

std::string read_whole(const std::string& path, std::size_t most) {
  claim_input(path);
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "rbe"),
                                                             std::fclose);
  const auto fail = [&] {
    throw std::runtime_error(fmt::format("{}: {}", path, std::strerror(errno)));
  };
  if (!file) fail();
  std::string text;
  std::array<char, 1 << 16> buffer;
  for (std::size_t n; (n = std::fread(buffer.data(), 1, buffer.size(), file.get())) > 0;) {
    if (text.size() + n > most) {
      throw std::runtime_error(fmt::format("{}: longer than {} bytes", path, most));
    }
    text.append(buffer.data(), n);
  }
  if (std::ferror(file.get()) != 0) fail();
  return text;
}

std::string read_json_text(const std::string& path) {
  constexpr int kDeepest = 64;
  std::string text = read_whole(path, std::size_t{64} << 20);
  if (nests_deeper(text, kDeepest)) {
    throw std::runtime_error(fmt::format("{}: its brackets nest deeper than {}", path, kDeepest));
  }
  return text;
}

}  // namespace tauext
