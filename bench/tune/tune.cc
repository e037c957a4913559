// SPDX-License-Identifier: Apache-2.0
#include "bench/tune/tune.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <limits>
#include <map>
#include <nlopt.hpp>
#include <optional>
#include <stdexcept>

namespace tauext {
namespace {

constexpr double kUnbearable = 1e30;  // from here on something never comes, or breaks a limit
constexpr double kNothing = 1e-9;     // what 0 counts as, which has no logarithm

// the mean of a metric over the seeds that have it; nothing where no seed is asked for it
struct Mean {
  double value = 0, never = 0;  // share of the seeds without a value
};
std::optional<Mean> mean_of(const std::vector<Score>& seeds, Metric m) {
  Mean mean;
  double asked = 0, values = 0;
  for (const Score& s : seeds) {
    const auto value = s.get(m);
    if (!value) continue;
    ++asked;
    if (std::isnan(*value) || !s.error.empty()) continue;
    ++values;
    mean.value += *value;
  }
  if (asked == 0) return std::nullopt;
  mean.never = 1 - values / asked;
  if (values > 0) mean.value /= values;
  return mean;
}

bool is_more_better(Metric m) {
  return row_of(m).better == Better::kMore;
}

class Search {
 public:
  explicit Search(const TuneOptions& o) : o_(o) {
    for (const TunedKey& k : o.keys) {
      low_.push_back(std::log(k.low));
      high_.push_back(std::log(k.high));
      first_.push_back(std::clamp(std::log(k.largest_start()), low_.back(), high_.back()));
    }
  }

  Tuned run() {
    check_ends();
    tuned_.start = pair_at(first_);
    const std::vector<std::vector<Score>> at_start = o_.score(tuned_.start);
    tuned_.evaluations = 1;
    require(at_start, o_.minimize, "--minimize");
    for (const auto& [metric, limit] : o_.limits) require(at_start, metric, "--limit");
    best_ = first_;
    best_value_ = objective(at_start);
    tuned_.of_start = in_units(best_value_);
    tuned_.start_breaks = tuned_.best_breaks = broken_by(at_start);
    search(nlopt::GN_DIRECT_L, o_.evaluations / 2);
    search(nlopt::LN_SBPLX, o_.evaluations);
    tuned_.best = pair_at(best_);
    tuned_.of_best = in_units(best_value_);
    for (std::size_t i = 0; i < o_.keys.size(); ++i) {
      const double margin = 1e-3 * (high_[i] - low_[i]);
      if (best_[i] < low_[i] + margin || best_[i] > high_[i] - margin)
        tuned_.at_bound.push_back(o_.keys[i].key);
    }
    return tuned_;
  }

 private:
  using Place = std::vector<double>;  // logarithms

  TunedPair pair_at(const Place& x) const {
    TunedPair pair = o_.pair;
    for (std::size_t i = 0; i < o_.keys.size(); ++i) {
      const TunedKey& k = o_.keys[i];
      const double factor = std::exp(x[i]) / k.largest_start();
      std::vector<std::string> values;
      for (const double v : k.start)
        values.push_back(fmt::format("{:.4g}", k.whole ? std::round(v * factor) : v * factor));
      std::string& specification = k.of_detector ? pair.detector : pair.estimator;
      specification += fmt::format(":{}={}", k.key, fmt::join(values, "/"));
    }
    return pair;
  }

  void check_ends() const {
    if (!o_.check) return;
    o_.check(pair_at(first_));
    for (std::size_t i = 0; i < o_.keys.size(); ++i) {
      for (const double end : {low_[i], high_[i]}) {
        Place x = first_;
        x[i] = end;
        try {
          o_.check(pair_at(x));
        } catch (const std::invalid_argument& e) {
          const TunedKey& k = o_.keys[i];
          throw std::invalid_argument(fmt::format(
              "--tune {}: its range, {:g} to {:g}, has an end that cannot be made ({}); --tune "
              "{}=LOW:HIGH sets another range",
              k.key, k.low, k.high, e.what(), k.key));
        }
      }
    }
  }

  // what the objective counts as broken, in words: of each metric that of the worst scenario
  std::string broken_by(const std::vector<std::vector<Score>>& runs) const {
    std::vector<std::string> all;
    const auto missing = [&](Metric m, double never) {
      if (never >= 1)
        all.push_back(fmt::format("{} never comes", key_of(m)));
      else if (never > 0)
        all.push_back(fmt::format("{} is missing for {:.2g} % of the seeds of a scenario",
                                  key_of(m), 100 * never));
    };
    double never = 0;
    for (const std::vector<Score>& seeds : runs) {
      if (const auto m = mean_of(seeds, o_.minimize)) never = std::max(never, m->never);
    }
    missing(o_.minimize, never);
    for (const auto& [metric, limit] : o_.limits) {
      const std::vector<Score>* worst = nullptr;
      for (const std::vector<Score>& seeds : runs) {
        if (excess(seeds, metric, limit) > (worst ? excess(*worst, metric, limit) : 0))
          worst = &seeds;
      }
      if (worst == nullptr) continue;
      const Mean m = mean_of(*worst, metric).value();
      const bool over = is_more_better(metric) ? m.value < limit : m.value > limit;
      if (m.never < 1 && over)
        all.push_back(
            fmt::format("{} is {:.4g}, and its limit is {:g}", key_of(metric), m.value, limit));
      missing(metric, m.never);
    }
    return fmt::format("{}", fmt::join(all, "; "));
  }

  double objective(const std::vector<std::vector<Score>>& runs) const {
    double sum = 0, count = 0, broken = 0;
    for (const std::vector<Score>& seeds : runs) {
      if (const auto m = mean_of(seeds, o_.minimize)) {
        const double value = std::log(std::max(m->value, kNothing));
        if (m->never < 1) sum += is_more_better(o_.minimize) ? -value : value, ++count;
        broken += m->never;
      }
      for (const auto& [metric, limit] : o_.limits) broken += excess(seeds, metric, limit);
    }
    if (broken > 0) return kUnbearable * (1 + broken);  // the less broken, the better
    return std::exp(sum / std::max(count, 1.));
  }

  static void require(const std::vector<std::vector<Score>>& runs, Metric m, const char* flag) {
    const auto has = [&](Metric metric) {
      return std::any_of(runs.begin(), runs.end(),
                         [&](const auto& seeds) { return mean_of(seeds, metric).has_value(); });
    };
    if (has(m)) return;
    std::vector<std::string> there;
    for (const MetricRow& row : kMetrics) {
      if (has(row.metric)) there.emplace_back(row.key);
    }
    throw std::invalid_argument(fmt::format("{} {}: no run has this metric; they have: {}", flag,
                                            key_of(m), fmt::join(there, ", ")));
  }

  static double excess(const std::vector<Score>& seeds, Metric metric, double limit) {
    const auto m = mean_of(seeds, metric);
    if (!m) return 0;
    const double over = is_more_better(metric) ? limit - m->value : m->value - limit;
    return std::max(over, 0.) / std::max(std::abs(limit), 1e-9 + std::abs(m->value)) + m->never;
  }

  // of the metric; NaN for what never comes, or breaks a limit
  double in_units(double objective) const {
    if (objective >= kUnbearable) return kNoValue;
    const double value = is_more_better(o_.minimize) ? 1 / objective : objective;
    return value > 1.001 * kNothing ? value : 0;
  }

  double evaluate(const Place& x) {
    const TunedPair pair = pair_at(x);
    const std::string name = pair.estimator + "+" + pair.detector;
    const auto known = known_.find(name);
    if (known != known_.end()) return known->second;
    const auto runs = o_.score(pair);
    const double value = known_[name] = objective(runs);
    ++tuned_.evaluations;
    if (o_.progress) o_.progress(std::min(1., 1. * tuned_.evaluations / o_.evaluations));
    if (value < best_value_) {
      best_value_ = value;
      best_ = x;
      tuned_.best_breaks = broken_by(runs);
    }
    return value;
  }

  // until so many evaluations have been made in all
  void search(nlopt::algorithm algorithm, int until) {
    if (tuned_.evaluations >= until) return;
    nlopt::opt search(algorithm, static_cast<unsigned>(o_.keys.size()));
    search.set_lower_bounds(low_);
    search.set_upper_bounds(high_);
    Place step;
    for (std::size_t i = 0; i < low_.size(); ++i) step.push_back((high_[i] - low_[i]) / 10);
    search.set_initial_step(step);
    search.set_xtol_abs(3e-3);  // 0.3 % of a number
    search.set_maxeval(4 * o_.evaluations);
    using Function = std::function<double(const Place&)>;
    std::exception_ptr thrown;  // which NLopt would make its own
    Function f = [&, until](const Place& x) {
      try {
        const double value = evaluate(x);
        if (tuned_.evaluations >= until) search.force_stop();
        return value;
      } catch (...) {
        thrown = std::current_exception();
        search.force_stop();
        return kUnbearable;
      }
    };
    search.set_min_objective([](const Place& x, Place&,
                                void* function) { return (*static_cast<Function*>(function))(x); },
                             &f);
    Place x = best_;
    double value = 0;
    try {
      search.optimize(x, value);
    } catch (const nlopt::forced_stop&) {       // the budget is used up
    } catch (const nlopt::roundoff_limited&) {  // nothing more can be won
    }
    if (thrown) std::rethrow_exception(thrown);
  }

  const TuneOptions& o_;
  Place low_, high_, first_, best_;
  double best_value_ = std::numeric_limits<double>::infinity();
  std::map<std::string, double> known_;
  Tuned tuned_;
};

}  // namespace

Tuned tune(const TuneOptions& o) {
  if (o.keys.empty()) throw std::invalid_argument("nothing to tune");
  return Search(o).run();
}

}  // namespace tauext
