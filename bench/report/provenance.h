// SPDX-License-Identifier: Apache-2.0
/// @file
/// Where results come from: every file of results has it as its "context". Not installed.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace tauext {

/// Keys and texts.
using Context = std::vector<std::pair<std::string, std::string>>;

/// What built this program: its version, the compiler and its flags.
std::string build();

/// The commit that this program was built from, followed by "-dirty" if files had been changed; ""
/// outside of git.
const char* commit();

/// First tauext (build(), MuJoCo's version and `run`), then date, commit (unless it was built
/// outside of git) and cpu (the processor's name).
/// @param run what the results depend on beside these, like "seed 1"
Context provenance(const std::string& run);

/// A file of a study's rows.
/// @param format of results_schema() (result_files.h)
/// @param rows a list, as JSON
std::string result_file(const std::string& format, const std::string& run, const std::string& rows);

}  // namespace tauext
