// SPDX-License-Identifier: Apache-2.0
// Makes of somebody's MJCF or URDF what every program here, and MuJoCo 2.2.2, reads.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

#include "bench/program/program.h"
#include "mjcf/import/mjcf_text.h"
#include "mjcf/plant/tree.h"
#include "mjcf/trace/atomic_file.h"
#include "mjcf/trace/input_file.h"
#include "mjcf/trace/printable.h"

namespace {

using namespace tauext;

std::string counted(const std::map<std::string, int>& all) {
  std::vector<std::string> words;
  for (const auto& [what, n] : all) words.push_back(fmt::format("{} {}", n, printable_name(what)));
  return fmt::format("{}", fmt::join(words, ", "));
}

// says what is wrong with it
ArmTree arm_of(const std::string& file, const ImportOptions& options) {
  const Model model = load_mjcf(file, options);
  try {
    return tree_of(model);
  } catch (const std::invalid_argument& e) {
    throw std::invalid_argument(fmt::format("{}: {}", file, e.what()));
  }
}

int import(const std::string& file, const ImportOptions& options, const std::string& out) {
  const ArmTree arm = arm_of(file, options);
  const ImportedText text = import_mjcf(file, options);
  double mass = 0;
  int slides = 0;
  for (const TreeJoint& j : arm.joints) {
    mass += j.mass;
    slides += j.kind == TreeJoint::Kind::kSlide;
  }
  AtomicFile to(out);
  to.write(text.xml);
  to.commit();
  say(fmt::format("{}: {} joints, {} of them slides, that move {:.4g} kg", out, arm.joints.size(),
                  slides, mass));
  if (!text.changed.empty()) say(fmt::format("changed: {}", counted(text.changed)));
  if (!text.dropped.empty()) say(fmt::format("left out: {}", counted(text.dropped)));
  return kGood;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "Reads an arm's MJCF or URDF as people have it, and writes what its dynamics needs, in one\n"
      "file that MuJoCo 2.2.2 reads: bodies, joints, masses and friction, and a motor of gain 1 "
      "on\n"
      "each joint. Says what it leaves out: actuators, meshes, contacts, newer attributes.\n"
      "--robot FILE does the same by itself.\n\n"
      "  tauext-import panda.xml --lock 'finger_joint.*' --out arm.xml\n",
      "tauext-import");
  std::string file, out;
  ImportOptions options;
  app.add_option("file", file, "MJCF or URDF file")->required()->type_name("FILE.xml|FILE.urdf");
  app.add_option("--lock", options.lock,
                 "fix joints whose whole name matches where they are 0; mass stays")
      ->type_name("REGEX");
  app.add_option("--out,-o", out, "file to write; - is standard output")->required();
  return run_program(app, argc, argv, [&] { return import(file, options, out); });
}
