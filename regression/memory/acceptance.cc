// SPDX-License-Identifier: Apache-2.0
#include "regression/memory/acceptance.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <sstream>
#include <stdexcept>
#include <tuple>

#include "mjcf/trace/input_file.h"
#include "mjcf/trace/known.h"
#include "mjcf/trace/text.h"

namespace tauext::gate {
namespace {

constexpr const char* kHeader = "# tauext accepted findings 1";
constexpr const char* kColumns = "layer\tsubject\tat most\tbase\treason";
constexpr const char* kEnd = "# end";

constexpr const char* kLayers[] = {kTimeLayer, kLongLayer, kInstructionsLayer, kCommittedLayer,
                                   kAccuracyLayer};

[[noreturn]] void refuse_at_most(const std::string& what, const std::string& where) {
  throw std::runtime_error(
      fmt::format("{}: at most is '{}', and must be a number like 0.03", where, what));
}

Acceptance acceptance_of(const std::string& line, const std::string& where) {
  std::istringstream in(line);
  std::vector<std::string> fields;
  for (std::string field; std::getline(in, field, '\t');) fields.push_back(field);
  if (fields.size() != 5) {
    throw std::runtime_error(
        fmt::format("{}: {} columns, and must be layer, subject, at most, base and reason", where,
                    fields.size()));
  }
  const auto at_most = number_in<double>(fields[2]);
  if (!at_most) refuse_at_most(fields[2], where);
  const Acceptance a{fields[0], fields[1], *at_most, fields[3], fields[4]};
  check_acceptance(a, where);
  return a;
}

}  // namespace

void check_acceptance(const Acceptance& a, const std::string& where) {
  if (!(a.at_most >= 0 && std::isfinite(a.at_most))) {
    refuse_at_most(fmt::format("{:g}", a.at_most), where);
  }
  find_known(
      kLayers, "layer", a.layer, [](const char* name) { return name; }, where);
  if (a.base.empty()) throw std::runtime_error(where + ": base is empty, and must be a commit");
}

bool Acceptance::covers(const std::string& its_layer, const std::string& its_subject,
                        double by) const {
  return layer == its_layer && subject == its_subject && by <= at_most;
}

std::string accepted_path(const std::string& folder) {
  return folder + "/accepted.tsv";
}

std::vector<Acceptance> read_acceptances(const std::string& path) {
  std::vector<Acceptance> all;
  if (!std::filesystem::exists(path)) return all;
  std::istringstream in(read_whole(path));
  int number = 0;
  bool end = false;
  for (std::string line; std::getline(in, line);) {
    if (end) throw std::runtime_error(fmt::format("{}: there are lines behind '{}'", path, kEnd));
    const std::string where = fmt::format("{}: line {}", path, ++number);
    if (number <= 2) {
      const char* const wanted = number == 1 ? kHeader : kColumns;
      if (line != wanted)
        throw std::runtime_error(
            fmt::format("{}: it must be '{}'; --accept writes this file", where, wanted));
    } else if (line == kEnd) {
      end = true;
    } else {
      all.push_back(acceptance_of(line, where));
    }
  }
  if (!end)
    throw std::runtime_error(fmt::format("{}: cut off, its last line is not '{}'", path, kEnd));
  return all;
}

std::string format_acceptances(std::vector<Acceptance> all) {
  const auto key = [](const Acceptance& a) { return std::tie(a.layer, a.subject, a.base); };
  std::sort(all.begin(), all.end(),
            [&](const Acceptance& a, const Acceptance& b) { return key(a) < key(b); });
  std::string text = fmt::format("{}\n{}\n", kHeader, kColumns);
  for (const Acceptance& a : all) {
    text +=
        fmt::format("{}\t{}\t{:.9g}\t{}\t{}\n", a.layer, a.subject, a.at_most, a.base, a.reason);
  }
  return text + kEnd + "\n";
}

}  // namespace tauext::gate
