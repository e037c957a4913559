// SPDX-License-Identifier: Apache-2.0
/// @file
/// Which files this process reads and is about to replace, by what they are and not by their names.
#pragma once

#include <sys/stat.h>

#include <string>

namespace tauext::claims {

/// A file is read.
/// @throws std::runtime_error naming the path, if it is about to be replaced
void add_input(const struct stat& file, const std::string& path);
void drop_input(const struct stat& file);

/// A file is about to be replaced, until drop_output.
/// @throws std::runtime_error naming the path, if it is read
void add_output(const struct stat& file, const std::string& path);
void drop_output(const struct stat& file);

}  // namespace tauext::claims
