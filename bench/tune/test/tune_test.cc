// SPDX-License-Identifier: Apache-2.0
#include "bench/tune/tune.h"

#include <gtest/gtest.h>

#include <cmath>

#include "bench/roster/specification.h"
#include "mjcf/test/error_of.h"

namespace tauext::test {
namespace {

Score score_of(double rmse, double noise) {
  Score s;
  s.set(Metric::kRmse, rmse);
  s.set(Metric::kNoise, noise);
  return s;
}

double number(const std::string& specification, const char* key) {
  return std::stod(key_of(specification, key).value());
}

// an error with its least value at a = 40, b = 0.5, and a noise that grows with a
TuneOptions bowl() {
  TuneOptions o;
  o.pair = {"mo", "det"};
  o.keys = {{"a", 1, 1000, false, {10}}, {"b", 0.01, 10, true, {1}}};
  o.evaluations = 200;
  o.score = [](const TunedPair& p) {
    const double a = number(p.estimator, "a"), b = number(p.detector, "b");
    const double x = std::log(a / 40), y = std::log(b / 0.5);
    return std::vector<std::vector<Score>>{{score_of(1 + x * x + y * y + x * y / 2, a / 100)}};
  };
  return o;
}

TEST(Tune, FindsTheBottomOfABowl) {
  const Tuned t = tune(bowl());
  EXPECT_NEAR(number(t.best.estimator, "a"), 40, 0.8);
  EXPECT_NEAR(number(t.best.detector, "b"), 0.5, 0.01);
  const double x = std::log(10 / 40.), y = std::log(1 / 0.5);
  EXPECT_NEAR(t.of_start, 1 + x * x + y * y + x * y / 2, 1e-9);
  EXPECT_NEAR(t.of_best, 1, 1e-3);
  EXPECT_TRUE(t.at_bound.empty());
  EXPECT_LE(t.evaluations, 200);
}

TEST(Tune, KeepsALimitAndSaysWhatIsAtABound) {
  TuneOptions o = bowl();
  o.limits = {{Metric::kNoise, 0.2}};  // a <= 20
  const Tuned t = tune(o);
  EXPECT_FALSE(std::isnan(t.of_best));
  EXPECT_NEAR(number(t.best.estimator, "a"), 20, 1);
  EXPECT_LE(number(t.best.estimator, "a"), 20);
  o = bowl();
  o.keys[0].high = 30;
  EXPECT_EQ(tune(o).at_bound, std::vector<std::string>{"a"});
  o.limits = {{Metric::kRecall, 1}};
  EXPECT_EQ(error_of([&] { tune(o); }),
            "--limit recall: no run has this metric; they have: rmse_Nm, noise_Nm");
  o.limits = {{Metric::kNoise, 1e-6}};  // which no place keeps
  const Tuned none = tune(o);
  EXPECT_TRUE(std::isnan(none.of_best));
  EXPECT_EQ(none.start_breaks, "noise_Nm is 0.1, and its limit is 1e-06");
  EXPECT_EQ(none.best_breaks, "noise_Nm is 0.01, and its limit is 1e-06");
}

TEST(Tune, AnEndThatCannotBeMadeIsSaidBeforeAnythingIsScored) {
  TuneOptions o = bowl();
  o.check = [](const TunedPair& p) {
    if (number(p.detector, "b") > 5) throw std::invalid_argument("b=10: it must be 0 to 5");
  };
  o.score = [](const TunedPair&) -> std::vector<std::vector<Score>> {
    throw std::invalid_argument("scored");
  };
  EXPECT_EQ(error_of([&] { tune(o); }),
            "--tune b: its range, 0.01 to 10, has an end that cannot be made (b=10: it must be 0 "
            "to 5); --tune b=LOW:HIGH sets another range");
}

TEST(Tune, AnErrorOfTheScoreIsItsOwn) {
  TuneOptions o = bowl();
  o.score = [n = 0](const TunedPair&) mutable -> std::vector<std::vector<Score>> {
    if (++n == 5) throw std::invalid_argument("X is 7, and must be 1 to 6");
    return {{score_of(1, 1)}};
  };
  EXPECT_NE(error_of([&] { tune(o); }).find("X is 7, and must be 1 to 6"), std::string::npos);
}

TEST(Tune, WhatNeverComesIsWorseThanAnyValue) {
  TuneOptions o = bowl();
  o.keys.resize(1);
  o.pair.detector = "";
  o.score = [](const TunedPair& p) {
    const double a = number(p.estimator, "a");
    return std::vector<std::vector<Score>>{{score_of(a > 15 ? std::nan("") : 100 / a, 0)}};
  };
  const double a = number(tune(o).best.estimator, "a");
  EXPECT_LE(a, 15);
  EXPECT_GT(a, 13);
}

TEST(Tune, SaysWhatIsMissingAndNamesNoLimitThatIsKept) {
  TuneOptions o = bowl();
  const double none = std::nan("");
  o.evaluations = 3;
  o.limits = {{Metric::kNoise, 1}};
  o.score = [&](const TunedPair&) -> std::vector<std::vector<Score>> {
    return {{score_of(1, 0.5), score_of(1, none), score_of(1, none), score_of(none, 0.5)}};
  };
  EXPECT_EQ(tune(o).start_breaks,
            "rmse_Nm is missing for 25 % of the seeds of a scenario; noise_Nm is missing for 50 % "
            "of the seeds of a scenario");
  o.score = [&](const TunedPair&) -> std::vector<std::vector<Score>> {
    return {{score_of(1, 2), score_of(1, none)}, {score_of(none, 0.5)}};
  };
  EXPECT_EQ(tune(o).start_breaks,
            "rmse_Nm never comes; noise_Nm is 2, and its limit is 1; noise_Nm is missing for 50 % "
            "of the seeds of a scenario");
}

TEST(Tune, KeysKeepTheProportionsOfJoints) {
  const std::vector<FieldHelp> fields = {{"X", "1", "", "", "600/300/150"},
                                         {"w", "rad/s", "", "", "10"},
                                         {"bandwidth", "rad/s", "", "", ""},
                                         {"Ts", "s", "", "", "0"}};
  const TunedPair pair{"ndob:w=20", ""};
  const auto keys = keys_of({"X=60:6000", "w"}, pair, fields, {});
  EXPECT_EQ(keys[0].start, (std::vector<double>{600, 300, 150}));
  EXPECT_NEAR(keys[1].low * keys[1].high, 400, 1e-9) << "about the specification's own value";
  EXPECT_EQ(without(pair, keys).estimator, "ndob");
  EXPECT_NEAR(keys_of({"Ts=0.1:0.4"}, pair, fields, {})[0].start[0], 0.2, 1e-12)
      << "a default of 0 is no place to begin";
  TuneOptions o;
  o.pair = {"ndob", ""};
  o.keys = {keys[0]};
  o.evaluations = 3;
  o.score = [](const TunedPair& p) {
    const std::string x = key_of(p.estimator, "X").value();
    const double first = std::stod(x), last = std::stod(x.substr(x.rfind('/') + 1));
    EXPECT_NEAR(first / last, 4, 1e-2) << x;
    return std::vector<std::vector<Score>>{{score_of(1, 1)}};
  };
  tune(o);
  EXPECT_NE(error_of([&] {
              keys_of({"bandwidth"}, pair, fields, {});
            }).find("no number above 0 to begin with"),
            std::string::npos);
  EXPECT_NE(error_of([&] { keys_of({"v"}, pair, fields, {}); }).find("unknown key; "),
            std::string::npos);
  EXPECT_NE(error_of([&] { keys_of({"w=5:2"}, pair, fields, {}); }).find("0 < LOW < HIGH"),
            std::string::npos);
  o.minimize = Metric::kDelay;
  EXPECT_NE(
      error_of([&] { tune(o); }).find("--minimize delay_s: no run has this metric; they have"),
      std::string::npos);
}

}  // namespace
}  // namespace tauext::test
