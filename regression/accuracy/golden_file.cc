// SPDX-License-Identifier: Apache-2.0
#include "regression/accuracy/golden_file.h"

#include <fmt/format.h>

#include <sstream>
#include <stdexcept>

#include "mjcf/trace/input_file.h"
#include "mjcf/trace/text.h"

namespace tauext::gate {
namespace {

constexpr const char* kHeader = "# tauext golden metrics 2";
constexpr const char* kEnd = "# end";

// fails with what is wrong with a line
struct At {
  const std::string& path;
  int line;
  [[noreturn]] void fail(const std::string& what) const {
    throw std::runtime_error(fmt::format("{}: line {}: {}", path, line, what));
  }
  double number(std::string_view text) const {
    if (const auto x = finite_number_in(text)) return *x;
    fail(fmt::format("'{}' is no number", text));
  }
};

void read_columns(const std::string& line, const At& at, Golden& g) {
  const std::vector<std::string_view> f = split(line, '\t');
  if (f.size() < 3 || f[0] != "entry") at.fail("the names of the columns were expected");
  g.seeds.assign(f.begin() + 2, f.end());
}

void read_metric(const std::string& line, const At& at, Golden& g) {
  const std::vector<std::string_view> f = split(line, '\t');
  if (f.size() != g.seeds.size() + 2) {
    at.fail(fmt::format("{} columns, where {} are named", f.size(), g.seeds.size() + 2));
  }
  GoldenLine l;
  for (std::size_t i = 2; i < f.size(); ++i) {
    l.values.push_back(f[i] == "never" ? kNever : at.number(f[i]));
  }
  if (!g.lines.emplace(std::pair(f[0], f[1]), std::move(l)).second) at.fail("is there twice");
}

std::string what_else(const std::string& line) {
  return line.starts_with("# tauext golden metrics 1")
             ? "golden metrics of an older version: remove the file, and --update writes it anew"
             : fmt::format("no golden metrics: it must be '{}'", kHeader);
}

}  // namespace

Golden parse_golden(const std::string& text, const std::string& path) {
  Golden g;
  std::istringstream in(text);
  std::string line;
  int number = 0;
  bool end = false;
  while (!end && std::getline(in, line)) {
    const At at{path, ++number};
    const auto colon = line.find(": ");
    if (number == 1) {
      if (line != kHeader) at.fail(what_else(line));
    } else if (line == kEnd) {
      end = true;
    } else if (line.starts_with("# ") && colon != std::string::npos) {
      g.header[line.substr(2, colon - 2)] = line.substr(colon + 2);
    } else if (g.seeds.empty()) {
      read_columns(line, at, g);
    } else {
      read_metric(line, at, g);
    }
  }
  if (number == 0) throw std::runtime_error(path + ": is empty");
  if (!end) {
    throw std::runtime_error(fmt::format("{}: cut off, its last line is not '{}'", path, kEnd));
  }
  if (g.lines.empty()) throw std::runtime_error(path + ": holds no metric");
  return g;
}

Golden read_golden(const std::string& path) {
  return parse_golden(read_whole(path), path);
}

}  // namespace tauext::gate
