// SPDX-License-Identifier: Apache-2.0
/// @file
/// Recordings of robots as people have them: CSV of any columns, .npy, .npz and ROS 2 bags.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "mjcf/trace/read/regularity.h"
#include "mjcf/trace/read/text/csv_rows.h"
#include "mjcf/trace/timed_rows.h"
#include "mjcf/trace/trace.h"

namespace tauext {

/// How a recording is to be read.
struct RecordingOptions {
  /// A preset or a TOML file of column_map.h; "": of a bag the preset for the topic's type, else
  /// `tauext`.
  std::string columns;
  std::string topic;  ///< of a bag; "": as BagRows chooses it
  /// The robot's joints by name, in its order: by these columns are found (joint_names.h), unless
  /// the map numbers them or has an `order`. Empty: unknown.
  std::vector<std::string> joints;
};

/// The rows of a file of any of these formats, which its first bytes tell; else it is CSV.
/// @param csv of a text
/// @throws std::runtime_error or std::invalid_argument naming the path and what is wrong
std::unique_ptr<RowSource> open_rows(const std::string& path, const RecordingOptions& options = {},
                                     const CsvFormat& csv = {});

/// A label of a contact that is none of a collision: somebody touches the arm on purpose.
inline constexpr std::uint8_t kIntended = 2;

/// A sample of a recording, and what else it says of that time. What it does not know is empty.
struct RecordedSample : Sample {
  Eigen::VectorXd tau_ext;   ///< [N m] true, sign of (3)
  Eigen::VectorXd driver;    ///< [N m] the maker's own estimate of it, the same sign
  Eigen::VectorXd force;     ///< [N] as Trace::force has it
  std::uint8_t contact = 0;  ///< the label, as Trace::contact has it
};

/// What a recording has beside t, q, qd and tau.
struct RecordingContents {
  int dof = 0;                      ///< joints
  bool torque_at_instants = false;  ///< samples/options.h
  bool tau_is_current = false;      ///< Trace::tau_is_current
  bool without_gravity = false;     ///< Trace::tau_without_gravity
  bool has_truth = false;           ///< whether it knows tau_ext
  bool has_driver = false;          ///< whether it knows the maker's estimate
  bool has_contact = false;         ///< whether it has labels
  double velocity_delay = 0;        ///< [s] of a qd that is made of q; 0 of one that is measured
};

/// A recording of any kind, sample by sample, in memory that does not grow with it.
class SampleSource {
 public:
  virtual ~SampleSource() = default;
  virtual const RecordingContents& contents() const = 0;  ///< the same for all samples
  /// The next one; false at the end. What the source does not have is left in it as it was.
  /// @throws std::runtime_error naming the path and what is wrong
  virtual bool next(RecordedSample& sample) = 0;
  virtual const Regularity& regularity() const = 0;  ///< of the samples so far
};

/// All samples that a source still has.
Trace trace_of(SampleSource& source);

/// A recording of these formats.
class RecordingReader final : public SampleSource {
 public:
  /// @throws std::runtime_error or std::invalid_argument naming the path and what is wrong with the
  /// file, or with its map
  RecordingReader(const std::string& path, const RecordingOptions& options);
  ~RecordingReader() override;

  const RecordingContents& contents() const override;
  /// Throws at the end, too, if there was no usable row.
  bool next(RecordedSample& sample) override;
  const Regularity& regularity() const override;
  const SkippedRows& skipped() const;  ///< rows that were left out so far

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// All of a recording.
/// @throws std::runtime_error as RecordingReader does
Trace read_recording(const std::string& path, const RecordingOptions& options, SkippedRows* skipped,
                     Regularity* regularity = nullptr);

}  // namespace tauext
