// SPDX-License-Identifier: Apache-2.0
/// @file
/// What the columns of somebody's recording mean: which of them are t, q, qd and so on, in which
/// unit, with which sign, in which order of the joints; and the samples that are made of them.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "mjcf/trace/read/text/csv_rows.h"

namespace tauext {

namespace detail {
class JointColumns;
}

/// A quantity of a recording, in the words of a map.
struct Quantity {
  std::string_view name;   ///< of its table
  std::string_view units;  ///< that it can have, apart by blanks; the first one is ours
  bool of_joints;          ///< a column for each joint
  std::string_view help;   ///< what it is
};

/// All of them.
inline constexpr Quantity kQuantities[] = {
    {"t", "s ms us ns", false, "time; several columns are added up"},
    {"q", "rad deg m mm", true, "position"},
    {"qd", "rad/s deg/s rpm m/s mm/s", true,
     "velocity; without it q is filtered and differentiated"},
    {"tau", "Nm Nmm N", true, "torque of the link's side, held until the next sample"},
    {"tau_instant", "Nm Nmm N", true, "the same, read at t; instead of tau"},
    {"current", "A mA", true,
     "of the drives; `gain` [N m/A], or that of a robot file, makes it tau_instant"},
    {"tau_without_gravity", "Nm Nmm N", true,
     "tau_instant less what holds the arm, which the robot's model adds"},
    {"tau_ext", "Nm Nmm N", true, "true external torque, sign of equation (3)"},
    {"driver", "Nm Nmm N", true, "the robot maker's own estimate of it, the same sign"},
    {"force", "N", false, "of a sensor: on the end effector, x, y and z of the world"},
    {"contact", "1", false, "label: not 0 while a collision acts"},
};

/// Those of which a recording has one: what stands for tau.
inline constexpr std::string_view kTorques[] = {"tau", "tau_instant", "current",
                                                "tau_without_gravity"};

/// Columns of a source that make a quantity: number i of it is `gain[i]` times column
/// `columns[i]`, and `zero[i]`.
struct MappedQuantity {
  std::vector<int> columns;  ///< from 0
  std::vector<double> gain;  ///< to SI units and the sign of equation (3)
  std::vector<double> zero;  ///< in SI units
  bool has_gain = false;     ///< whether the map says one
  std::optional<bool>
      held;  ///< whether it is a torque that holds until the next sample, if it says
};

/// Those of a recording, by their names.
using MappedColumns = std::map<std::string, MappedQuantity, std::less<>>;

/// A map, as its file has it (column_map_file.h).
///
/// A table of TOML for each quantity that there is: `columns`, a regular expression for their whole
/// names (joints in the order of the number in its group, else by the robot's names in the group,
/// or in these names), a list of names (joints by the robot's, if it has all of them, and else in
/// its order), or a list of numbers from 1;
/// `unit`, `gain`, `sign` and, in SI units, `zero`, one for all or one for each of these columns;
/// `file`, which has them (files/several_files.h); `held` of a torque (kTorques), by default true
/// for `tau` alone. A torque takes the place of the preset's, and its columns where it has none.
/// Above the tables: `preset`, a map to begin with, `separator`, `header` (false: no line of
/// names), `order` (which joint of the recording each joint of the robot is, from 1), `rate` [Hz]
/// instead of [t], `velocity_filter` [rad/s], `join` [s], `parts`, an expression for the names of
/// files in a folder.
class ColumnMap {
 public:
  /// Which columns of a source make which quantity; those that it does not have are missing.
  /// @param joints the robot's, by name, in its order; empty: unknown
  /// @param notes what there is to say of how these were found; may be null
  /// @throws std::runtime_error naming the path, the quantity and what was looked for
  MappedColumns mapped(const std::vector<std::string>& columns, const std::string& path,
                       const std::vector<std::string>& joints = {},
                       std::vector<std::string>* notes = nullptr) const;

  /// A sentence for each quantity that the map's own tables name, not its preset, and that is not
  /// among those found.
  std::vector<std::string> missing_in(const MappedColumns& found) const;

  /// Where a preset finds currents beside a torque, leaves the torque, and says so; else "".
  std::string choose_torque(MappedColumns& found, const std::vector<std::string>& columns) const;

  /// Whether it says nothing of which joint is which: its q is a preset's, and it has no `order`.
  bool leaves_order_open() const;

  const CsvFormat& csv() const { return csv_; }  ///< how its text is written
  /// [Hz] at which rows follow each other, where they have no time; 0: they have one.
  double rate() const { return rate_; }
  /// [s] how far apart rows that have a part of a sample each may be (joined_rows.h); 0: a row is a
  /// sample.
  double join() const { return join_; }
  /// An expression for the names of files that follow each other (several_files.h); "": one file.
  const std::string& parts() const { return parts_; }
  /// The files that quantities name, each once.
  std::vector<std::string> files() const;
  bool needs_first_file() const;  ///< whether a quantity names none
  /// [rad/s] of the filter that makes qd of q where there is none: two poles there.
  double velocity_filter() const { return velocity_filter_; }

 private:
  friend class MapReader;

  // what one table says
  struct Wanted {
    std::string expression;                // or
    std::vector<std::string> names;        // or
    std::vector<int> numbers;              // from 1
    std::vector<std::string> units;        // one, or one of each
    std::vector<double> gain, sign, zero;  // likewise
    std::string file;                      // that has them; "": the recording's own
    std::optional<bool> held;
    bool of_preset = false;  // whose sources need not have it
  };

  std::vector<int> find_matching(std::string_view quantity, const Wanted& w,
                                 const std::vector<std::string>& columns, const std::string& path,
                                 detail::JointColumns& joints) const;
  std::vector<int> find(std::string_view quantity, const Wanted& w,
                        const std::vector<std::string>& columns, const std::string& path,
                        detail::JointColumns& joints) const;
  std::vector<int> find_in_file(std::string_view quantity, const Wanted& w,
                                const std::vector<std::string>& columns, const std::string& path,
                                detail::JointColumns& joints) const;
  std::vector<int> order_of(std::string_view quantity, const Wanted& w, const std::string& path,
                            detail::JointColumns& joints) const;
  void put_in_order(std::string_view quantity, const std::vector<int>& order, MappedQuantity& m,
                    const std::string& path) const;

  std::map<std::string, Wanted, std::less<>> wanted_;
  std::vector<int> order_;
  std::string parts_;
  CsvFormat csv_;
  double rate_ = 0, velocity_filter_ = 100, join_ = 0;
};

/// Where the quantities of a sample stand, side by side and in SI units, and of which columns they
/// are made; t is the first.
struct SampleLayout {
  int dof = 0;                                  ///< joints
  int q = -1, qd = -1, tau = -1, tau_ext = -1;  ///< where each begins; -1: it has none
  int driver = -1, force = -1, contact = -1;    ///< likewise
  int size = 1;                                 ///< numbers
  bool instants = false;                        ///< tau was read at t
  bool currents = false;                  ///< tau is in A: of drives whose gains are not known
  bool without_gravity = false;           ///< Trace::tau_without_gravity
  std::vector<std::pair<int, double>> t;  ///< columns and gains, which are added up; may be none
  /// What makes another number of a row.
  struct Number {
    int column;   ///< of the row, from 0
    double gain;  ///< to SI units
    double zero;  ///< [SI] that is added then
  };
  std::vector<Number> rest;        ///< all others
  std::vector<std::string> names;  ///< of all, like "[q] of joint 2"; the first is that of t

  std::vector<int> columns() const;  ///< that matter
  /// The sample of a row [SI], without a time of columns 0.
  void convert(const std::vector<double>& row, std::vector<double>& sample) const;
};

/// The layout of the samples that the columns of a recording make.
/// @param has_t whether there must be a time
/// @throws std::runtime_error naming the path and what is missing, or does not fit
SampleLayout layout_of(const MappedColumns& mapped, const std::vector<std::string>& columns,
                       const std::string& path, bool has_t = true);

}  // namespace tauext
