// SPDX-License-Identifier: Apache-2.0
/// @file
/// What every commit of a branch measured, a line of JSON each; and how one is measured.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "regression/memory/acceptance.h"

namespace tauext::gate {

/// A kernel of a commit, beside the reference's.
struct KernelRecord {
  double ratio = 1;          ///< [1] commit / reference, of a step's time; 1 if identical
  double low = 1, high = 1;  ///< [1] its interval, 95 %
  /// [1] the step is slower by at least this share, with 99 % confidence over all kernels
  /// together; 0 or less: not surely slower
  double surely = 0;
  std::optional<double> ns;       ///< [ns] of a step; none where it is identical and was not timed
  double instructions = 0;        ///< [1] of a step
  double instructions_ratio = 1;  ///< [1] commit / reference, counted by one machine
};

/// What a commit measured.
struct Record {
  std::string commit, date, title;              ///< as git says them
  std::string reference;                        ///< the commit that ran beside it
  std::string machine;                          ///< processor and compiler
  std::map<std::string, KernelRecord> kernels;  ///< those that both commits have
  /// By "entry metric": the mean over the seeds, NaN for "never". Those that differ from the record
  /// before.
  std::map<std::string, double> metrics;
  std::vector<std::string> gone;     ///< metrics that the record before had
  std::vector<Acceptance> accepted;  ///< in the commit's tree
};

/// @throws std::runtime_error unless commit and date are one word each
void check_record(const Record& record);

/// One line of the file, without an end.
std::string format_record(const Record& record);

/// @param path to be named in errors
/// @throws std::runtime_error naming path and line: no JSON, something missing, another version
std::vector<Record> parse_history(const std::string& text, const std::string& path);

/// Of a file that need not be there.
/// @throws std::runtime_error as parse_history does
std::vector<Record> read_history(const std::string& path);

/// All metrics as they stood at the end of so many records.
std::map<std::string, double> metrics_after(const std::vector<Record>& history,
                                            std::size_t records);

/// What is measured, beside what.
struct MeasureOptions {
  std::string base, head;        ///< plug-ins of the reference and of the commit
  std::string bench;             ///< the commit's program with --golden; empty: no metrics
  std::string baselines;         ///< the commit's folder, for what it accepts
  std::string kernels, entries;  ///< regular expressions; empty: all
  Record record;  ///< commit, date, title and reference, none of them empty but the title
  std::function<void(const std::string&)> progress;  ///< may be empty
};

/// The record of that commit, with all metrics that are not as at the end of `history`. Kernels of
/// one side alone are left out; what is too noisy for a verdict has no `surely`.
/// @throws std::invalid_argument for a name that is empty or a commit that is on record,
/// std::runtime_error for files and programs
Record measure(const MeasureOptions& options, const std::vector<Record>& history);

}  // namespace tauext::gate
