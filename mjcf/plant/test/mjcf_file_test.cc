// SPDX-License-Identifier: Apache-2.0
#include "mjcf/plant/mjcf_file.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>
#include <signal.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <filesystem>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

#include "mjcf/plant/model.h"
#include "mjcf/plant/plant.h"
#include "mjcf/test/error_of.h"

namespace tauext::test {
namespace {

namespace fs = std::filesystem;

class MjcfFile : public testing::Test {
 protected:
  void SetUp() override { fs::create_directories(folder_); }
  void TearDown() override { fs::remove_all(folder_); }

  std::string put(const std::string& xml) {
    std::ofstream(path_) << xml;
    return path_;
  }
  // an arm of one hinge with these attributes, and this before it
  std::string arm(const std::string& attributes, const std::string& before = "") {
    return put("<mujoco>" + before + "<worldbody><body name='link'><joint name='elbow' " +
               attributes + "/><geom size='1'/></body></worldbody></mujoco>");
  }
  std::string error(const std::string& path, const Limits& limits = {}) {
    return error_of([&] { compiled_mjcf(path, limits); });
  }

  const fs::path folder_ = fs::path(testing::TempDir()) / fmt::format("mjcf_file_{}", ::getpid());
  const std::string path_ = folder_ / "robot.xml";
};

TEST_F(MjcfFile, ComesBackAsMuJoCoItselfCompilesIt) {
  for (const char* name : {"wallmobot3", "testbed1"}) {
    const std::string path = fmt::format("mjcf/{}.xml", name);
    const std::string bytes = compiled_mjcf(path);
    char why[1000];
    mjModel* const m = mj_loadXML(path.c_str(), nullptr, why, sizeof why);
    ASSERT_NE(m, nullptr) << why;
    std::string own(static_cast<std::size_t>(mj_sizeModel(m)), '\0');
    mj_saveModel(m, nullptr, own.data(), static_cast<int>(own.size()));
    mj_deleteModel(m);
    EXPECT_TRUE(bytes == own) << name;
    EXPECT_EQ(load_mjcf(path)->nv, load_robot(name)->nv);
  }
}

TEST_F(MjcfFile, NumbersOfNoArmAreRefusedWithTheirElement) {
  for (const auto& [attributes, why] : std::vector<std::pair<std::string, std::string>>{
           {"armature='-0.1'", "armature is -0.1, and must be 0 to 1e+06"},
           {"damping='-3'", "damping is -3, and must be 0 to 1e+06"},
           {"damping='1e300'", "damping is 1e+300, and must be 0 to 1e+06"},
           {"frictionloss='-1'", "frictionloss is -1, and must be 0 to 1e+06"},
           {"stiffness='-1'", "stiffness is -1, and must be 0 to 1e+09"},
           {"damping='nan'", "damping is nan, and must be 0 to 1e+06"},
           {"armature='inf'", "armature is inf, and must be 0 to 1e+06"},
           {"ref='nan'", "ref is nan, and must be finite"},
           {"solreflimit='nan 1'", "solreflimit is nan, and must be finite"},
           {"pos='nan 0 0'", "pos is nan, and must be -1e+06 to 1e+06"}}) {
    EXPECT_EQ(error(arm(attributes)), path_ + ": joint 'elbow': " + why);
  }
  EXPECT_EQ(error(arm("armature='0.1' damping='0'")), "no error");
}

TEST_F(MjcfFile, SoAreThoseOfItsOptionsTendonsSitesAndMotors) {
  for (const auto& [option, why] : std::vector<std::pair<std::string, std::string>>{
           {"gravity='0 0 nan'", "gravity is nan, and must be -1000 to 1000"},
           {"timestep='-0.001'", "timestep is -0.001, and must be 1e-09 to 1"},
           {"timestep='0'", "timestep is 0, and must be 1e-09 to 1"},
           {"iterations='100000'", "iterations is 100000, and must be 0 to 1000"}}) {
    EXPECT_EQ(error(arm("", "<option " + option + "/>")), path_ + ": option: " + why);
  }
  const auto arm_with = [&](const std::string& site, const std::string& behind) {
    return error(put("<mujoco><worldbody><body><joint name='a'/><geom size='1'/>" + site +
                     "</body></worldbody>" + behind + "</mujoco>"));
  };
  EXPECT_EQ(
      arm_with("", "<tendon><fixed damping='-1'><joint joint='a' coef='1'/></fixed></tendon>"),
      path_ + ": tendon 0: damping is -1, and must be 0 to 1e+06");
  const std::string turn =
      error(put("<mujoco><worldbody><body name='link' quat='0 0 0 0'><joint/><geom size='1'/>"
                "</body></worldbody></mujoco>"));
  EXPECT_TRUE(turn == path_ + ": body 'link': quat has the length 0, and must turn" ||
              turn.find("zero quaternion") != turn.npos)  // as MuJoCo 3 says it
      << turn;
  EXPECT_EQ(arm_with("<site name='tip' pos='nan 0 0'/>", ""),
            path_ + ": site 'tip': pos is nan, and must be -1e+06 to 1e+06");
  EXPECT_EQ(arm_with("",
                     "<actuator><motor name='m' joint='a' ctrllimited='true' ctrlrange='nan "
                     "nan'/></actuator>"),
            path_ + ": actuator 'm': ctrlrange is nan, and must be finite");
}

TEST_F(MjcfFile, WhatMuJoCoSaysIsOneLine) {
  const std::string schema = error(arm("strength='3'"));
  EXPECT_TRUE(schema.starts_with(path_ + ": line 1: <joint> has no attribute")) << schema;
  EXPECT_NE(schema.find("'strength'"), std::string::npos) << schema;
  const std::string name = error(
      put("<mujoco><worldbody><body><joint name='a&#10;b' damping='-1'/><geom size='1'/></body>"
          "</worldbody></mujoco>"));
  EXPECT_EQ(name, path_ + ": joint 'a?b': damping is -1, and must be 0 to 1e+06");
  const std::string layout = error_of([&] {
    Plant(load_mjcf(
        put("<mujoco><option integrator='RK4'/><worldbody><body><joint name='j'/><geom "
            "size='1'/></body></worldbody>"
            "<actuator><general name='a&#10;b' joint='j' gainprm='3'/></actuator></mujoco>")));
  });
  EXPECT_NE(layout.find("and 'a?b' is none"), std::string::npos) << layout;
  for (const std::string& xml : {std::string("no xml"), std::string("<mujoco>"), std::string()}) {
    EXPECT_EQ(error(put(xml)).find('\n'), std::string::npos) << error(put(xml));
  }
  EXPECT_EQ(schema.find('\n'), std::string::npos) << schema;
}

TEST_F(MjcfFile, NoFileEndsOrHoldsThisProcess) {
  const auto not_done = [](const std::string& path) {
    return path +
           ": MuJoCo is not done after 1 s when it loads this robot. Textures can be left out, and "
           "meshes where every body has an <inertial>; each <include> must name a file";
  };
  // MuJoCo 2.2.2 crashes, 3.5 has room for it
  const std::string huge = error(arm("",
                                     "<asset><texture name='sky' type='2d' builtin='flat' "
                                     "width='40000' height='40000'/></asset>"));
  EXPECT_TRUE(huge.starts_with(path_ + ": ") || mjVERSION_HEADER >= 300) << huge;

  const fs::path pipe = folder_ / "pipe.xml";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  EXPECT_EQ(error(put("<mujoco><include file='pipe.xml'/></mujoco>"), {.time = 1}),
            not_done(path_));
  EXPECT_EQ(error(pipe, {.time = 1}), pipe.string() + ": it is no regular file");
}

TEST(Confined, GivesTheBytesBack) {
  std::string much(5'000'000, 'x');
  much[17] = '\0';
  EXPECT_TRUE(confined({}, [&] { return much; }) == much);
  EXPECT_EQ(confined({}, [] { return std::string(); }), "");
}

TEST(Confined, WhateverHappensThereIsAnError) {
  const auto says = [](const Limits& limits, auto&& work) {
    return error_of([&] {
      confined(limits, [&]() -> std::string {
        work();
        return "";
      });
    });
  };
  EXPECT_EQ(says({}, [] { throw std::invalid_argument("too round"); }), "too round");
  EXPECT_EQ(says({}, [] { throw 42; }), "an exception without words");
  EXPECT_EQ(says({}, [] { ::raise(SIGSEGV); }), "crashes (Segmentation fault)");
  EXPECT_EQ(says({}, [] { ::_exit(0); }), "ends without a result");
  EXPECT_EQ(says({.time = 0.2}, [] { ::pause(); }), "is not done after 0.2 s");
  EXPECT_EQ(says({.time = 0.2},
                 [] {
                   for (std::atomic<int> i = 0;; ++i) {
                   }
                 }),
            "is not done after 0.2 s");
  const std::string path = testing::TempDir() + fmt::format("confined_{}", ::getpid());
  EXPECT_EQ(says({}, [&] { std::ofstream(path) << "written" << std::flush; }),
            "crashes (File size limit exceeded)");
  EXPECT_EQ(fs::file_size(path), 0u);
  fs::remove(path);
}

TEST(Confined, TakesNoMoreThanItsMemory) {
#ifdef TAUEXT_SANITIZED
  GTEST_SKIP() << "the limit does not hold under sanitizers";
#endif
  EXPECT_EQ(error_of([] {
              confined({.memory = std::size_t{50} << 20},
                       [] { return std::string(std::size_t{500} << 20, 'x'); });
            }),
            "needs more than 50 MB");
}

}  // namespace
}  // namespace tauext::test
