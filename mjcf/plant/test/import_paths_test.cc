// SPDX-License-Identifier: Apache-2.0
// Where something stands in MJCF files, and where an imported one says that its meshes are.
#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "mjcf/import/mjcf_text.h"
#include "mjcf/plant/mjcf_file.h"
#include "mjcf/plant/test/robot_folder.h"
#include "mjcf/plant/tree.h"
#include "mjcf/test/error_of.h"

namespace tauext::test {
namespace {

class ImportPaths : public RobotFolder {};

TEST_F(ImportPaths, AFileWithoutXmlHasNoLineToBlame) {
  for (const auto& [text, words] : std::vector<std::pair<std::string, std::string>>{
           {"", "the file is empty"},
           {"\n \n", "no XML (empty document)"},
           {"<!-- none -->", "no XML (no element)"},
           {"<mujoco>\n<a></b>", "line 2: no XML (mismatched element)"}}) {
    EXPECT_EQ(error_of([&, text = text] { import_mjcf(put(text)); }), words);
    EXPECT_EQ(error_of([&, text = text] { is_urdf(put(text)); }), words);
    const std::string hand = put(text, "hand.xml");
    EXPECT_EQ(error_of([&] { import_mjcf(body("<include file='hand.xml'/>")); }),
              hand + ": " + words);
  }
}

TEST_F(ImportPaths, ErrorsInOtherFilesNameTheseAndTheirLines) {
  const std::string hand = folder_ / "hand.xml";
  const auto error = [&](const std::string& text) {
    put("<mujoco>\n" + text + "\n</mujoco>", "hand.xml");
    return error_of([&] { import_mjcf(body("<include file='hand.xml'/>")); });
  };
  EXPECT_TRUE(error("<body>\n<joint nam='a'/></body>")
                  .starts_with(hand + ": line 3: <joint> has no attribute 'nam'"));
  EXPECT_TRUE(error("<body><jiont/></body>").starts_with(hand + ": line 2: "));
  EXPECT_TRUE(error("<body name='a&#27;'/>").starts_with(hand + ": line 2: name of <body>"));
  EXPECT_NE(error("<body name='b'><joint/><inertial pos='0 0 0' mass='1' diaginertia='.1 .2 .5'/>"
                  "</body>")
                .find("'b' (" + hand + ": line 2) 0.1, 0.2 and 0.5"),
            std::string::npos);
  EXPECT_EQ(error("<body><joint name='a'/><geom size='.1'/></body>"), "no error");
  const ImportedText text = import_mjcf(body("<include file='hand.xml'/>"));
  EXPECT_EQ(text.xml.find("hand.xml"), std::string::npos) << text.xml;
}

// what a mass comes from stays, by a path from the text's own folder
TEST_F(ImportPaths, NamesNoFolderOfThisMachine) {
  std::filesystem::create_directories(folder_ / "assets");
  put("v 0 0 0\nv .3 0 0\nv 0 .2 0\nv 0 0 .1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n",
      "assets/m.obj");
  const auto with_mass_of = [&](const std::string& geom, const std::string& compiler) {
    return put("<mujoco><compiler " + compiler +
               "/><asset><mesh file='m.obj'/></asset><worldbody><body><joint name='a' axis='1 0 "
               "0'/><geom type='mesh' mesh='m'/>" +
               geom + "</body></worldbody></mujoco>");
  };
  const std::string inertial = "<inertial pos='0 0 .1' mass='1' diaginertia='.1 .1 .1'/>";
  for (const std::string compiler : {"meshdir='assets'", "assetdir='assets'"}) {
    const std::string none = import_mjcf(with_mass_of(inertial, compiler)).xml;
    EXPECT_EQ(none.find("dir="), std::string::npos) << none;
    EXPECT_EQ(none.find(folder_.string()), std::string::npos) << none;
  }
  const std::string path = with_mass_of("", "strippath='true' meshdir='assets'");
  const double mass = tree_of(load_mjcf(path)).joints[0].mass;
  std::filesystem::create_directories(folder_ / "out");
  for (const std::string folder : {"", "out", "assets"}) {
    const std::string text = import_mjcf(path, {.folder = folder_ / folder}).xml;
    EXPECT_EQ(text.find(folder_.string()), std::string::npos) << text;
    EXPECT_EQ(text.find("dir="), std::string::npos) << text;
    const std::string again = put(text, (std::filesystem::path(folder) / "again.xml").string());
    EXPECT_EQ(tree_of(load_mjcf(again)).joints[0].mass, mass) << folder;
  }
}

}  // namespace
}  // namespace tauext::test
