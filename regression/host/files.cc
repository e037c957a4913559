// SPDX-License-Identifier: Apache-2.0
#include "regression/host/files.h"

#include <fmt/format.h>

#include <cstdlib>
#include <filesystem>
#include <stdexcept>

#include "regression/host/ending.h"

namespace tauext::gate {

TemporaryFolder::TemporaryFolder() {
  std::string pattern = (std::filesystem::temp_directory_path() / "tauext-gate-XXXXXX").string();
  if (!::mkdtemp(pattern.data())) throw std::runtime_error(pattern + ": cannot make this folder");
  path_ = pattern;
  list_folder(path_);
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
  unlist_folder(path_);
}

std::string TemporaryFolder::copy(const std::string& file, const std::string& name) const {
  const std::filesystem::path to = std::filesystem::path(path_) / name;
  std::error_code error;
  std::filesystem::copy_file(file, to, error);
  if (error) throw std::runtime_error(fmt::format("{}: {}", file, error.message()));
  return to.string();
}

}  // namespace tauext::gate
