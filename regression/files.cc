// SPDX-License-Identifier: Apache-2.0
#include "regression/files.h"

#include <fstream>
#include <iterator>
#include <stdexcept>

namespace tauext::gate {

std::string read_file(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  std::string bytes((std::istreambuf_iterator<char>(in)), {});
  if (!in.good() && !in.eof()) throw std::runtime_error(path + ": cannot be read");
  return bytes;
}

}  // namespace tauext::gate
