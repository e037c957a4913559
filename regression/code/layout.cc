// SPDX-License-Identifier: Apache-2.0
#include "regression/code/layout.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <string_view>

#include "mjcf/trace/digest.h"
#include "regression/code/assembly.h"

namespace tauext::gate {
namespace {

constexpr int kPeriod = 512;  // [bytes] what lies there runs alike, as far as anybody has seen
constexpr int kStep = 16;     // [bytes]

// Steele, Lea and Flood 2014, splitmix64
std::uint64_t mixed(std::uint64_t x) {
  x += 0x9e3779b97f4a7c15u;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
  return x ^ (x >> 31);
}

bool never_passed(std::string_view word) {
  constexpr std::string_view kWords[] = {"jmp", "ret", "b", "br"};  // of x86 and of aarch64
  return std::find(std::begin(kWords), std::end(kWords), word) != std::end(kWords);
}

}  // namespace

std::string laid_out(const std::string& assembly, std::uint64_t seed, const LayoutNames& names) {
  // aarch64's instructions are whole words, and its assembler wants to know
  const bool words = assembly.find("\t.arch armv8") != std::string::npos;
  std::set<std::string_view> functions;
  std::uint64_t of_function = 0, place = 0;
  std::string out;
  out.reserve(assembly.size() * 5 / 4);
  const auto skip = [&](std::uint64_t bytes) {
    if (bytes > 0) out += fmt::format("\t.skip {}\n", bytes);
  };
  for (const std::string_view line : lines_of(assembly)) {
    const std::string_view word = first_word(line), label = label_of(line);
    if (const std::string_view function = function_of(line); !function.empty()) {
      functions.insert(function);
    }
    if (functions.contains(label)) {
      const auto it = names.find(label);
      of_function = mixed(fnv1a(it == names.end() ? label : it->second) + mixed(seed));
      place = 0;
      out += fmt::format("\t.balign {}\n", kPeriod);
      skip(kStep * (of_function % (kPeriod / kStep)));
    }
    out.append(line).push_back('\n');
    if (never_passed(word)) {
      const std::uint64_t random = mixed(of_function + ++place);
      const std::uint64_t bytes = 1 + (random >> 8) % 63;
      if (random % 2 == 0) skip(words ? (bytes + 3) / 4 * 4 : bytes);
    }
  }
  return out;
}

}  // namespace tauext::gate
