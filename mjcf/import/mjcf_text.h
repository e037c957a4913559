// SPDX-License-Identifier: Apache-2.0
/// @file
/// An arm's MJCF or URDF as people have it, made into what MuJoCo 2.2.2 reads.
#pragma once

#include <map>
#include <set>
#include <string>

#include "mjcf/import/measured_terms.h"

namespace tauext {

/// What becomes of a robot's file.
struct ImportOptions {
  /// A regular expression (ECMAScript): joints whose whole name matches are fixed where they are 0,
  /// with the mass behind them. None if it is empty.
  std::string lock;
  MeasuredTerms measured;  ///< in the place of what the file says
  bool balance = false;    ///< mend inertias that no body has
  /// Bodies that move without a mass are no error, and get one that means nothing: for whoever
  /// finds out what they have.
  bool masses_unknown = false;
  /// From which the text names the files of meshes, as MuJoCo does from its own; "": by their whole
  /// paths, for a text that is in no folder.
  std::string folder = "";

  /// Whether the file is to be taken as it is.
  bool changes_nothing() const { return lock.empty() && measured.empty(); }
};

/// A text, and what of the file is not in it.
struct ImportedText {
  std::string xml;                     ///< MJCF, in one piece
  std::map<std::string, int> dropped;  ///< how often each element or attribute, like "geom (mesh)"
  std::map<std::string, int> changed;  ///< what is different, like "joint locked"
  std::set<std::string> massless;      ///< bodies, as ImportOptions::masses_unknown has it
};

/// What is different and what is left out, each with its number, in one line; "" if nothing is.
std::string in_words(const ImportedText& text);

/// Whether the file is URDF, and none that MuJoCo should be shown.
/// @throws std::runtime_error as import_mjcf does, for a file that cannot be read or is no XML
bool is_urdf(const std::string& path);

/// MuJoCo takes a mass of nan for one that is not given.
/// @throws std::runtime_error in one line, naming the element of the file that says so
void refuse_nan(const std::string& path);

/// For a file that MuJoCo cannot read: it does not say that a comma in 2,9 is to blame.
/// @throws std::runtime_error in one line, naming the first such element
void refuse_commas(const std::string& path);

/// Of the file, with all that it includes, the bodies, joints, masses and springs: what dynamics
/// needs, and MuJoCo 2.2.2 knows. Its actuators are dropped; joints that follow
/// no other get a motor of unit gain.
/// Meshes are left out but where a mass depends on them. Ranges are limits, as in newer MuJoCo.
/// @throws std::runtime_error in one line, naming the element and the remedy, and the file if it is
/// an included one
ImportedText import_mjcf(const std::string& path, const ImportOptions& options = {});

}  // namespace tauext
