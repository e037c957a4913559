// SPDX-License-Identifier: Apache-2.0
/// @file
/// Results as one page for a browser, which asks for nothing from anywhere. Not installed.
#pragma once

#include <string>
#include <vector>

#include "bench/report/result_files.h"

namespace tauext::report {

/// What tauext-bench --report calls the two things that its page holds; whoever reads that page
/// calls them by its name.
inline constexpr const char *kOwnResults = "results.json", *kOwnTraces = "traces.json";

/// The page of these results: it holds them as they are, and draws them.
std::string page_of(const std::vector<ResultFile>& results);

/// The results of a file: one, or all that such a page holds, if it is .html.
/// @throws std::runtime_error naming the file, for a page that is none of ours, and as
/// checked_result()
std::vector<ResultFile> read_results(const std::string& path);

/// @param flag that names the path, for the error
/// @throws std::invalid_argument for another name than FILE.html, by which browsers and
/// read_results() know a page
void require_page(const std::string& path, const std::string& flag);

}  // namespace tauext::report
