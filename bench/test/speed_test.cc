// SPDX-License-Identifier: Apache-2.0
// Times as ratios within one process, blocks in turn: the only figures that hold on a busy machine.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <functional>
#include <memory>
#include <thread>
#include <vector>

#include "bench/live/histogram.h"
#include "bench/live/live.h"
#include "bench/peers/textbook_ekf.h"
#include "bench/roster/pair.h"
#include "bench/roster/robots.h"
#include "estimators/ekf.h"
#include "estimators/ndob.h"
#include "estimators/runs/runs.h"
#include "mjcf/record.h"

namespace tauext::test {
namespace {

using peers::TextbookEkf;

using Batch = std::function<void()>;

double seconds_of(const Batch& batch) {
  const auto start = std::chrono::steady_clock::now();
  batch();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

// median over pairs of time(a) / time(b)
double median_ratio(const Batch& a, const Batch& b) {
  constexpr int kPairs = 301;
  a(), b();
  std::vector<double> r;
  for (int i = 0; i < kPairs; ++i) {
    const double time_a = seconds_of(a);
    r.push_back(time_a / seconds_of(b));
  }
  std::nth_element(r.begin(), r.begin() + kPairs / 2, r.end());
  return r[kPairs / 2];
}

using Make = std::function<Batch()>;  // each at another place in memory

// the first of up to five that reaches the limit, else the last: a neighbour on the machine can
// spoil one for a while, a place in memory a batch for its life (a ratio of 2.0 where 60 others
// were 2.8), so each attempt has batches at other places; a slower estimator spoils them all
double ratio(const Make& a, const Make& b, double limit) {
  std::vector<Batch> kept;
  double r = 0;
  for (int attempt = 0; attempt < 5 && r < limit; ++attempt) {
    kept.push_back(a()), kept.push_back(b());
    r = median_ratio(kept[kept.size() - 2], kept.back());
  }
  return r;
}

Batch batch_of(Pair pair, const Trace& trace) {
  return [runner = std::make_shared<Runner>(std::move(pair), trace)] { runner->batch(); };
}

class Speed : public testing::Test {
 protected:
  Make runner(const char* estimator) const {
    return [this, estimator] {
      return batch_of(robot("wallmobot3").pair(estimator, "", trace_), trace_);
    };
  }
  Trace trace_ = record(load_robot("wallmobot3"), scenario("wallmobot3", "sine"));
};

TEST_F(Speed, TheEkfIsEightTimesFasterThanTheDenseTextbookForm) {
  using Textbook = TextbookEkf<double>;
  const Make textbook = [&] {
    auto stage = std::make_unique<EstimatorStageOf<Textbook>>(
        Textbook(Ekf<WallMoBot3>::Parameters::paper()));
    return batch_of({std::move(stage), nullptr}, trace_);
  };
  const double r = ratio(textbook, runner("ekf"), 9);
  std::printf("textbook / ekf: %.2f\n", r);
  EXPECT_GE(r, 8) << "11 where it was measured; the rest is for code layout and neighbours";
}

TEST_F(Speed, TheTestbedsEkfTakesLessThanHalfOfWallmobot3s) {
  // which takes up to 180 ns: so one joint stays below 80
  const Scenario& s = scenario("testbed1", "model_check");
  const Trace trace = record(load_for("testbed1", s), s);
  const Make one = [&] { return batch_of(robot("testbed1").pair("ekf", "", trace), trace); };
  const double r = ratio(runner("ekf"), one, 2.3);
  std::printf("wallmobot3's ekf / testbed1's: %.2f\n", r);
  EXPECT_GE(r, 2.3);
}

TEST_F(Speed, TheNdobIsMoreThanTwiceAsFastAsTheEkf) {
  const double r = ratio(runner("ekf"), runner("ndob"), 2);
  std::printf("ekf / ndob: %.2f\n", r);
  EXPECT_GE(r, 2) << "2.4 where it was measured; the rest is for code layout and neighbours";
}

TEST_F(Speed, EveryOtherEstimatorKeepsItsDistanceToTheEkf) {
  // measured, in this order: 2.5, 2.5, 2.0, 2.0, 1.9, 1.1, 1.9, 0.88, 0.8, and on another processor
  // 2.25, 2.27, 1.85, 1.85, 1.75, 1.35, 1.69, 0.77, 0.71; the EKF's time differs from start to
  // start, and the rest, a tenth, is for code layout and neighbours
  const std::pair<const char*, double> kLeast[] = {
      {"mo1", 2.0}, {"ndob_wb", 2.0}, {"mo2", 1.65}, {"mo3", 1.65},        {"smo", 1.55},
      {"aob", 0.9}, {"eso", 0.9},     {"dkf", 0.65}, {"dkf_adaptive", 0.6}};
  for (const auto& [name, least] : kLeast) {
    const double r = ratio(runner("ekf"), runner(name), least);
    std::printf("ekf / %s: %.2f\n", name, r);
    EXPECT_GE(r, least) << name;
  }
}

// kRuns of an estimator at once over samples of one, each a little later than the last
template <ForRuns E>
class AtOnce {
 public:
  AtOnce(const typename E::Parameters& p, const Trace& trace) : runs_(WallMoBot3(), p) {
    for (int k = 0; k < Runner::kBatch; ++k) {
      for (int i = 0; i < kRuns; ++i) put(trace.measurement<3>(k + 10 * i), i, samples_[k]);
    }
  }
  void batch() {
    runs_.reset();
    for (const auto& y : samples_) sum_ += runs_.update(y).tau_ext[0][0];
  }

 private:
  Runs<E> runs_;
  std::vector<typename Runs<E>::Sample> samples_{Runner::kBatch};
  double sum_ = 0;
};

TEST_F(Speed, RunsAtOnceTakeLessThanARunAlone) {
#ifndef __AVX2__
  GTEST_SKIP() << "built without AVX2 (TAUEXT_ARCH): a register holds two runs";
#endif
  const auto check = [&]<typename E>(const char* name, double least) {
    const Make at_once = [&]() -> Batch {
      const auto all = std::make_shared<AtOnce<E>>(E::Parameters::paper(), trace_);
      return [all] { all->batch(); };
    };
    const double r = kRuns * ratio(runner(name), at_once, least / kRuns);
    std::printf("%s / one of %d at once: %.2f\n", name, kRuns, r);
    EXPECT_GE(r, least) << name;
  };
  // 2.0 where nobody else is there; registers that are shared with a busy thread make it 1.6
  check.operator()<Ekf<WallMoBot3>>("ekf", kRuns == 8 ? 3 : 1.4);
  check.operator()<Ndob<WallMoBot3>>("ndob", kRuns == 8 ? 3 : 1.8);
}

// pushes as a cycle with three estimators makes them, five times as often, while the other thread
// takes them out; and what the clock takes to be read
void push_for_a_second(live::Histogram& push_ns, live::Histogram& clock_ns) {
  LiveStream stream(nullptr, live::streams_of({"a", "b", "c"}, "d"), 200);
  LiveSample s;
  s.reading.n = 3;
  for (int cycle = 0; cycle < 5000; ++cycle) {
    std::this_thread::sleep_for(std::chrono::microseconds(200));
    s.reading.utime = 1000 * cycle;
    const auto woken = std::chrono::steady_clock::now();
    clock_ns.add((std::chrono::steady_clock::now() - woken).count());
    for (s.stream = 0; s.stream < 3; ++s.stream) {
      const auto begin = std::chrono::steady_clock::now();
      ASSERT_TRUE(stream.push(s));
      push_ns.add((std::chrono::steady_clock::now() - begin).count());
    }
  }
}

TEST(Push, CostsTheLoopNextToNothing) {
  // the best of up to five: a neighbour can spoil a second, a push that waits spoils them all; what
  // a virtual machine takes from one push in a thousand says nothing of us. In times that the clock
  // takes to be read after such a sleep: how fast a machine wakes differs from hour to hour.
  constexpr double kMost = 8;  // one that wakes somebody takes dozens
  double share = 1e9, median = 0, rare = 1e9;
  for (int attempt = 0; attempt < 5 && (share >= kMost || rare >= 10'000); ++attempt) {
    live::Histogram push_ns, clock_ns;
    push_for_a_second(push_ns, clock_ns);
    median = push_ns.quantile(0.5);
    share = std::min(share, median / clock_ns.quantile(0.5));
    rare = std::min(rare, push_ns.quantile(0.99));
  }
  std::printf("a push: %.0f ns (median), %.1f times a clock's reading; %.0f ns (99 %%)\n", median,
              share, rare);
  EXPECT_LT(share, kMost);
  EXPECT_LT(rare, 10'000);
}

}  // namespace
}  // namespace tauext::test
