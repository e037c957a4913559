// SPDX-License-Identifier: Apache-2.0
// What a recording has, through an MCAP file and back; mcap_writer_test.cc looks at its bytes.
#include "bench/logs/mcap_samples.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <cstddef>
#include <filesystem>
#include <string>

#include "mjcf/test/error_of.h"
#include "mjcf/trace/input_file.h"
#include "mjcf/trace/test/same_trace.h"
#include "mjcf/trace/test/some_trace.h"

namespace tauext::test {
namespace {

namespace fs = std::filesystem;

class McapRun : public testing::Test {
 protected:
  McapRun()
      : path_(fs::temp_directory_path() / ("tauext_run_" + std::to_string(::getpid()) + ".mcap")) {}
  ~McapRun() override { fs::remove(path_); }

  Trace again() const {
    SkippedRows skipped;
    Trace trace = read_recording(path_.string(), {}, &skipped);
    EXPECT_EQ(skipped.total(), 0);
    EXPECT_TRUE(skipped.notes.empty());
    return trace;
  }
  Trace through_a_file(const Trace& t) const {
    release_input(path_.string());
    write_mcap(t, path_.string());
    return again();
  }

  fs::path path_;
};

TEST_F(McapRun, ComesBackBitForBit) {
  Trace run = some_trace(3, 20'000);
  run.q(0, 7) = -0.0;
  for (double& t : run.t) t += 1.7e9;  // whose nanoseconds a double does not have
  expect_same(through_a_file(run), run);
  EXPECT_TRUE(std::signbit(again().q(0, 7)));
  EXPECT_FALSE(again().torque_at_instants);
  run.torque_at_instants = true;
  for (double& t : run.t) t -= 1.7e9 + 5;  // the first of which are below 0
  expect_same(through_a_file(run), run);
  EXPECT_TRUE(again().torque_at_instants);
}

TEST_F(McapRun, HasNoMoreTruthThanIsKnown) {
  Trace run = some_trace(2, 10);
  run.contact.clear();
  EXPECT_TRUE(through_a_file(run).has_truth());
  EXPECT_TRUE(again().contact.empty());
  run = some_trace(2, 10);
  run.tau_ext.resize(2, 0);
  EXPECT_FALSE(through_a_file(run).has_truth());
  EXPECT_EQ(again().contact, run.contact);
  run.contact.clear();
  EXPECT_FALSE(through_a_file(run).has_truth());
  EXPECT_TRUE(again().contact.empty());
}

TEST_F(McapRun, SaysWhatItsTorqueIs) {
  Trace run = some_trace(2, 10);
  run.torque_at_instants = run.tau_is_current = true;
  EXPECT_TRUE(through_a_file(run).tau_is_current);
  EXPECT_EQ(again().tau, run.tau);
  run.tau_is_current = false, run.tau_without_gravity = true;
  EXPECT_TRUE(through_a_file(run).tau_without_gravity);
  EXPECT_EQ(again().tau, run.tau);
  fs::remove(path_), release_input(path_.string());
  run.torque_at_instants = false;
  const std::string error = error_of([&] { write_mcap(run, path_.string()); });
  EXPECT_TRUE(error.starts_with(path_.string() + ": the log's torques without gravity hold"))
      << error;
  EXPECT_FALSE(fs::exists(path_));
}

TEST_F(McapRun, KeepsTheMakersEstimateAndAForce) {
  const Trace run = some_trace(2, 3);
  RecordingContents has;
  has.dof = 2, has.has_driver = true;
  RecordedSample y;
  y.force = Eigen::Vector3d(1, 2, 3), y.driver = Eigen::Vector2d(4, 5);
  {
    McapWriter file(path_.string());
    McapSamples samples(file, has, y, path_.string());
    for (int k = 0; k < run.size(); ++k) {
      y.t = run.t[static_cast<std::size_t>(k)], y.q = run.q.col(k), y.qd = run.qd.col(k);
      samples.write(y, run.tau.col(k));
    }
    file.commit();
  }
  const Trace t = again();
  EXPECT_EQ(t.force, y.force.replicate(1, 3));
  EXPECT_EQ(t.tau_ext_of_driver, y.driver.replicate(1, 3));
  EXPECT_EQ(t.tau, run.tau);
}

}  // namespace
}  // namespace tauext::test
