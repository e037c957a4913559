// SPDX-License-Identifier: Apache-2.0
// Makes of somebody's MJCF or URDF what every program here, and MuJoCo 2.2.2, reads.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <cctype>
#include <cstddef>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

#include "bench/program/program.h"
#include "mjcf/import/robot_file.h"
#include "mjcf/plant/mjcf_file.h"
#include "mjcf/plant/remedy/doubts.h"
#include "mjcf/plant/simulated.h"
#include "mjcf/plant/tree.h"
#include "mjcf/trace/atomic_file.h"
#include "mjcf/trace/input_file.h"
#include "mjcf/trace/printable.h"

namespace {

using namespace tauext;

// says what is wrong with it
ArmTree arm_of(const Model& model, const std::string& file, const ImportOptions& options) {
  try {
    return tree_of(model);
  } catch (const std::invalid_argument& e) {
    throw std::invalid_argument(
        fmt::format("{}: {}", file, why_no_arm(e.what(), file, {}, options)));
  }
}

template <class Numbers>
std::string listed(const Numbers& all) {
  return fmt::format("{{{:.17g}}}", fmt::join(all.reshaped().begin(), all.reshaped().end(), ", "));
}

// by rows, as Eigen's << takes them
std::string rows(const Eigen::MatrixXd& m) {
  const Eigen::MatrixXd t = m.transpose();
  return fmt::format("{:.17g}", fmt::join(t.reshaped().begin(), t.reshaped().end(), ", "));
}

// the arm as a function that returns its model
std::string cpp_of(const ArmTree& arm, const std::string& file, const ImportOptions& options,
                   const std::string& out) {
  std::string name = "make_" + std::filesystem::path(out).stem().string();
  for (char& c : name) c = std::isalnum(static_cast<unsigned char>(c)) ? c : '_';
  const std::size_t joints = arm.joints.size();
  const bool tied = joints > static_cast<std::size_t>(arm.dof());
  const std::string type = tied
                               ? fmt::format("tauext::TreeModel<{}, double, {}>", arm.dof(), joints)
                               : fmt::format("tauext::TreeModel<{}>", joints);
  std::string text = fmt::format(
      "// Made by tauext-import from {}{}.\n#pragma once\n\n#include "
      "\"estimators/tree/tree_model.h\"\n\ninline {} {}() {{\n  {}::Parameters p;\n  using K = "
      "tauext::TreeJoint::Kind;\n",
      printable_name(std::filesystem::path(file).filename().string()),
      options.lock.empty() ? "" : " --lock " + printable_name(options.lock), type, name, type);
  for (std::size_t i = 0; i < joints; ++i) {
    const TreeJoint& j = arm.joints[i];
    text += fmt::format(
        "  {{\n    tauext::TreeJoint& j = p.joints[{}];\n    j.parent = {};\n    j.kind = K::{};\n"
        "    j.axis = {};\n    j.rotation << {};\n    j.position = {};\n    j.zero = {:.17g};\n"
        "    j.mass = {:.17g};\n    j.center = {};\n    j.inertia << {};\n    j.armature = "
        "{:.17g};\n"
        "    j.viscous = {:.17g};\n    j.viscous_skew = {:.17g};\n    j.dry = {:.17g};\n"
        "    j.v_s = {:.17g};\n    j.offset = {:.17g};\n  }}\n",
        i, j.parent, j.kind == TreeJoint::Kind::kSlide ? "kSlide" : "kHinge", listed(j.axis),
        rows(j.rotation), listed(j.position), j.zero, j.mass, listed(j.center), rows(j.inertia),
        j.armature, j.viscous, j.viscous_skew, j.dry, j.v_s, j.offset);
  }
  return text +
         fmt::format("  p.gravity = {};\n  p.drho << {};\n  p.rho0 << {};\n  return {}(p);\n}}\n",
                     listed(arm.gravity), rows(arm.drho), rows(arm.rho0), type);
}

int import(const std::string& path, const ImportOptions& how, const std::string& out) {
  if (out != "-" && !out.ends_with(".xml") && !out.ends_with(".h"))
    throw std::invalid_argument(
        fmt::format("--out {}: MJCF goes to a name that ends in .xml, C++ to one in .h", out));
  const auto [file, options] = robot_file(path, how);
  const Model model = load_mjcf(file, options);
  const ArmTree arm = arm_of(model, file, options);
  ImportOptions written = options;
  written.folder = std::filesystem::absolute(out).parent_path().string();
  const ImportedText text = import_mjcf(file, written);
  double mass = 0;
  int slides = 0;
  for (const TreeJoint& j : arm.joints) {
    mass += j.mass;
    slides += j.kind == TreeJoint::Kind::kSlide;
  }
  AtomicFile to(out);
  to.write(out.ends_with(".h") ? cpp_of(arm, file, options, out) : text.xml);
  to.commit();
  const std::size_t followers = arm.joints.size() - static_cast<std::size_t>(arm.dof());
  say(fmt::format(
      "{}: {} joints, {} of them slides, that move {:.4g} kg{}", out, arm.joints.size(), slides,
      mass,
      followers > 0 ? fmt::format("; {} follow{} another, which triples the time of a step (--lock "
                                  "fixes joints)",
                                  followers, followers == 1 ? "s" : "")
                    : ""));
  if (arm.dof() > kMostCoordinates || followers > kMostFollowers)
    say(why_no_arm(
        fmt::format("note: estimators take arms of 1 to {} joints and up to {} more that follow "
                    "them; --lock fixes others",
                    kMostCoordinates, kMostFollowers),
        file, {}, options));
  if (const std::string stiff = too_stiff(model); !stiff.empty())
    say("note: it cannot be simulated: " + stiff);
  if (const std::string doubts = doubts_about(*model); !doubts.empty()) say(doubts);
  if (const std::string words = in_words(text); !words.empty()) say(words);
  return kGood;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "Reads an arm's MJCF or URDF as people have it, and writes what its dynamics needs, in one\n"
      "file that MuJoCo 2.2.2 reads: bodies, joints, masses and friction, and a motor of gain 1 "
      "on\n"
      "each joint that follows no other. Says what it leaves out: actuators, meshes, contacts.\n"
      "--robot FILE does the same by itself. To a file that ends in .h it writes the arm as C++:\n"
      "a function that returns its TreeModel, which needs Eigen alone.\n\n"
      "  tauext-import panda.xml --lock 'finger_joint.*' --out arm.xml\n",
      "tauext-import");
  std::string file, out;
  ImportOptions options;
  app.add_option("file", file, "MJCF or URDF file, or robot file of ours (.json)")
      ->required()
      ->type_name("FILE.xml|FILE.mjcf|FILE.urdf|FILE.json");
  app.add_option("--lock", options.lock,
                 "fix joints whose whole name matches where they are 0; mass stays")
      ->type_name("REGEX")
      ->check(not_empty);
  app.add_flag("--balance", options.balance, "mend inertias that no body has, and say by how much");
  app.add_option("--out,-o", out, "file to write; - is standard output")->required();
  return run_program(app, argc, argv, [&] { return import(file, options, out); });
}
