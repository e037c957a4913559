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
#include <thread>
#include <utility>
#include <vector>

#include "mjcf/plant/model.h"
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
    const std::string path = fmt::format(TAUEXT_MJCF "/{}.xml", name);
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
           {"armature='-0.1'", "joint 'elbow': armature is -0.1, and must be 0 or more"},
           {"damping='-3'", "joint 'elbow': damping is -3, and must be 0 or more"},
           {"frictionloss='-1'", "joint 'elbow': frictionloss is -1, and must be 0 or more"},
           {"stiffness='-1'", "joint 'elbow': stiffness is -1, and must be 0 or more"},
           {"damping='nan'", "joint 'elbow': damping is nan, and must be 0 or more"},
           {"armature='inf'", "joint 'elbow': armature is inf, and must be 0 or more"},
           {"pos='nan 0 0'", "joint 'elbow': pos is nan, and must be finite"}}) {
    EXPECT_EQ(error(arm(attributes)), path_ + ": " + why);
  }
  EXPECT_EQ(error(arm("", "<option gravity='0 0 nan'/>")), path_ + ": option: gravity is nan");
  EXPECT_EQ(error(arm("", "<option timestep='-0.001'/>")),
            path_ + ": option: timestep is -0.001 s, and must be positive");
  EXPECT_EQ(error(arm("", "<option timestep='0'/>")),
            path_ + ": option: timestep is 0 s, and must be positive");
  EXPECT_EQ(
      error(put("<mujoco><worldbody><body><joint name='a'/><geom size='1'/></body></worldbody>"
                "<tendon><fixed damping='-1'><joint joint='a' coef='1'/></fixed></tendon>"
                "</mujoco>")),
      path_ + ": tendon 0: damping is -1, and must be 0 or more");
  EXPECT_EQ(error(arm("armature='0.1' damping='0'")), "no error");
}

TEST_F(MjcfFile, WhatMuJoCoSaysIsOneLine) {
  const std::string schema = error(arm("strength='3'"));
  EXPECT_TRUE(schema.starts_with(path_ + ": XML Error: Schema violation")) << schema;
  EXPECT_NE(schema.find("'strength'"), std::string::npos) << schema;
  for (const std::string& xml : {std::string("no xml"), std::string("<mujoco>"), std::string()}) {
    EXPECT_EQ(error(put(xml)).find('\n'), std::string::npos) << error(put(xml));
  }
  EXPECT_EQ(schema.find('\n'), std::string::npos) << schema;
}

TEST_F(MjcfFile, NoFileEndsOrHoldsThisProcess) {
  const auto unfinished = [](const std::string& path, const std::string& why) {
    return path + ": MuJoCo " + why +
           " while it loads it; leave out what dynamics does not need (textures, meshes), and "
           "includes that are no files";
  };
  const std::string texture =
      "<asset><texture name='sky' type='2d' builtin='flat' width='40000' height='40000'/></asset>";
  EXPECT_EQ(error(arm("", texture)), unfinished(path_, "crashes (Segmentation fault)"));

  const fs::path pipe = folder_ / "pipe.xml";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  EXPECT_EQ(error(put("<mujoco><include file='pipe.xml'/></mujoco>"), {.time = 1}),
            unfinished(path_, "is not done after 1 s"));
  EXPECT_EQ(error(pipe, {.time = 1}), unfinished(pipe.string(), "is not done after 1 s"));
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
  EXPECT_EQ(says({}, [] { ::raise(SIGSEGV); }), "crashes (Segmentation fault)");
  EXPECT_EQ(says({}, [] { ::_exit(0); }), "ends without a word");
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
