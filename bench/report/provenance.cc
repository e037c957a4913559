// SPDX-License-Identifier: Apache-2.0
#include "bench/report/provenance.h"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <ctime>
#include <fstream>
#include <nlohmann/json.hpp>

#include "bench/roster/robots.h"
#include "mjcf/record.h"

namespace tauext {
namespace {

std::string processor() {
  std::ifstream info("/proc/cpuinfo");
  for (std::string line; std::getline(info, line);) {
    if (line.starts_with("model name")) return line.substr(line.find(": ") + 2);
  }
  return "unknown";
}

}  // namespace

std::string build() {
  const std::string arch = level().empty() ? "" : " -march=" + level();
  return fmt::format("tauext {}, {}, {}{}", TAUEXT_VERSION, TAUEXT_COMPILER, TAUEXT_FLAGS, arch);
}

Context provenance(const std::string& run) {
  Context c = {{"tauext", fmt::format("{}, MuJoCo {}, {}", build(), mujoco_version(), run)},
               {"date", fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(std::time(nullptr)))}};
  if (*commit() != '\0') c.emplace_back("commit", commit());
  c.emplace_back("cpu", processor());
  return c;
}

std::string result_file(const std::string& format, const std::string& run,
                        const std::string& rows) {
  nlohmann::ordered_json j = {{"format", format}};
  for (const auto& [key, text] : provenance(run)) j["context"][key] = text;
  j["rows"] = nlohmann::ordered_json::parse(rows);
  return j.dump(1) + "\n";
}

}  // namespace tauext
