// SPDX-License-Identifier: Apache-2.0
#include "bench/report/traces.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <random>
#include <vector>

#include "bench/roster/robots.h"

namespace tauext::report {
namespace {

Eigen::VectorXd noise(int n, double height, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal(0, height);
  return Eigen::VectorXd::NullaryExpr(n, [&] { return normal(random); });
}

// what value i of a drawn signal stands for
double drawn_value(const Drawn& d, std::size_t i) {
  return d.low + d.values[i] / 65535. * (d.high - d.low);
}

// every sample lies between the two extremes of its bucket, and both are samples of it
void expect_drawn(const Eigen::VectorXd& s, const std::vector<int>& edges) {
  const Drawn d = draw(s, edges);
  ASSERT_EQ(d.values.size(), 2 * (edges.size() - 1));
  const double step = (d.high - d.low) / 65535;
  for (std::size_t b = 0; b + 1 < edges.size(); ++b) {
    const auto part = s.segment(edges[b], edges[b + 1] - edges[b]);
    const double first = drawn_value(d, 2 * b), second = drawn_value(d, 2 * b + 1);
    EXPECT_NEAR(std::max(first, second), part.maxCoeff(), step);
    EXPECT_NEAR(std::min(first, second), part.minCoeff(), step);
    Eigen::Index most = 0, least = 0;
    part.maxCoeff(&most), part.minCoeff(&least);
    if (std::abs(first - second) > step) {
      EXPECT_EQ(first > second, most < least) << "the order in time";
    }
  }
}

TEST(Traces, EveryPulseOfThreeSamplesIsDrawnToItsHeight) {
#ifdef TAUEXT_SANITIZED
  constexpr unsigned kSeeds = 3;
#else
  constexpr unsigned kSeeds = 100;
#endif
  for (unsigned seed = 0; seed < kSeeds; ++seed) {
    Eigen::VectorXd s = noise(30'000, 1, seed);
    const int at = static_cast<int>(seed) * 297 + 5;
    s.segment<3>(at).array() += 25;
    const std::vector<int> edges = bucket_edges({Signals{s, noise(30'000, 3, seed + 1000)}});
    EXPECT_EQ(edges.size(), kBuckets + 1);
    const Drawn d = draw(s, edges);
    EXPECT_EQ(d.high, s.segment<3>(at).maxCoeff());
    EXPECT_GE(std::count(d.values.begin(), d.values.end(), 65535), 1) << seed;
  }
}

TEST(Traces, BucketsHoldTheirSamples) {
  const Eigen::VectorXd s = noise(5000, 2, 1);
  const std::vector<int> edges = bucket_edges({Signals{s}});
  EXPECT_EQ(edges.front(), 0);
  EXPECT_EQ(edges.back(), 5000);
  EXPECT_TRUE(std::is_sorted(edges.begin(), edges.end()));
  EXPECT_EQ(std::adjacent_find(edges.begin(), edges.end()), edges.end());
  expect_drawn(s, edges);
}

TEST(Traces, AStepIsResolvedToTheSampleAndRestIsNot) {
  Eigen::VectorXd s = Eigen::VectorXd::Zero(30'000);
  s.tail(29'000).setConstant(98.2);
  const std::vector<int> edges = bucket_edges({Signals{s}});
  EXPECT_EQ(std::count(edges.begin(), edges.end(), 1000), 1);
  expect_drawn(s, edges);
}

TEST(Traces, AStepStandsWhereItIsBesideRoundingNoise) {
  for (const double height : {4e-14, 1e-9, 1e-4}) {  // [N m]
    constexpr int kSamples = 30'000, kStep = 1966;
    Trace trace;
    trace.q = Eigen::MatrixXd::Zero(3, kSamples);
    trace.tau_ext = Eigen::MatrixXd::Zero(3, kSamples);
    trace.tau_ext.row(0).tail(kSamples - kStep).setConstant(3);
    trace.tau_ext.row(0).tail(kSamples / 2).setConstant(10);
    trace.tau_ext.row(1) = noise(kSamples, height, 1);
    for (int k = 0; k < kSamples; ++k) trace.t.push_back(k * 1e-3);
    Output estimate;
    estimate.tau_ext = trace.tau_ext;
    estimate.tau_ext.row(2) = noise(kSamples, height, 2);
    Traces traces;
    traces.add(Entry("wallmobot3", "contact", "mo2"), {trace, estimate, {}});
    const auto group = nlohmann::json::parse(traces.json("here"))["groups"][0];
    const auto t = group["t"].get<std::vector<double>>();
    for (const std::size_t k : {kStep - 1, kStep})  // the last before it, and the first of it
      EXPECT_GE(std::count(t.begin(), t.end(), trace.t[k]), 1) << trace.t[k] << " s, " << height;
  }
}

TEST(Traces, AFewSamplesAreBucketsOfOne) {
  const Eigen::VectorXd s = noise(7, 1, 4);
  const std::vector<int> edges = bucket_edges({Signals{s}});
  EXPECT_EQ(edges, (std::vector<int>{0, 1, 2, 3, 4, 5, 6, 7}));
  expect_drawn(s, edges);
}

TEST(Traces, WhatIsNotFiniteIsDrawnAsZero) {
  Eigen::VectorXd s = Eigen::VectorXd::Constant(10, 4);
  s[3] = std::numeric_limits<double>::quiet_NaN();
  s[4] = std::numeric_limits<double>::infinity();
  const Drawn d = draw(s, {0, 5, 10});
  EXPECT_EQ(d.low, 0);
  EXPECT_EQ(d.high, 4);
}

TEST(Traces, AForceIsThatWhoseTorquesAreTheTruth) {
  const Robot& r = robot("wallmobot3");
  const auto forces = r.forces_at(kEndEffector, false);
  const Vec<3> force(3, 0, 5);  // in the plane of the joints, which sees all of it
  Trace trace;
  trace.q = Vec<3>(0.4, 0.8, -0.5).replicate(1, 4);
  trace.tau_ext.resize(3, 4);
  for (int k = 0; k < 4; ++k) {
    trace.t.push_back(k * 1e-3);
    trace.tau_ext.col(k) = forces->torque(trace.q.col(k), (k + 1) * force);
  }
  Output none;
  none.tau_ext = Eigen::MatrixXd::Zero(3, 4);
  Traces traces;
  traces.add(Entry("wallmobot3", "step", "mo2"), {trace, none, {}}, forces.get());
  const auto j = nlohmann::json::parse(traces.json("here"));
  const auto& series = j["groups"][0]["series"];
  for (int axis = 0; axis < 3; ++axis) {
    const auto& drawn = series[0]["wrench"][axis];
    EXPECT_NEAR(drawn["low"], std::min(force[axis], 4 * force[axis]), 1e-9) << axis;
    EXPECT_NEAR(drawn["high"], std::max(force[axis], 4 * force[axis]), 1e-9) << axis;
    EXPECT_EQ(series[1]["wrench"][axis]["high"], 0) << axis;
  }
}

}  // namespace
}  // namespace tauext::report
