// SPDX-License-Identifier: Apache-2.0
/// @file
/// Several runs of one estimator at once, one in each SIMD lane: of other samples, or with other
/// parameters. A sample that is plain (samples/plain.h) in all runs is a step of all at once. With
/// any other one, and where a run is left out, starts or diverges, each run does that sample on its
/// own, by the estimator of doubles. So nothing branches by runs, and each run is as if it were
/// alone, but for how a compiler rounds.
///
/// An estimator over a model can do it (bench/examples/twice.h is one) if
/// - it computes with the model's number (ScalarOf), which then is a Pack. Where it has to branch,
///   it asks all(..), or takes each run's by select(..), after `using tauext::all, tauext::select`,
///   which doubles have, too. A Pack has abs, copysign, cos, exp, expm1, max, min, sin, sqrt and
///   tanh, called without std:: after `using std::exp`, and no other function;
/// - it has `Model`, `For` (the same over another model), parameters(), and is made of a model and
///   Parameters;
/// - Parameters lists all its members in fields(), or in unnamed() those that no specification
///   names. What may differ from run to run is a Scalar, or a vector or matrix of it;
/// - memory() lists what it remembers, its Sampling first: in Scalars, too.
/// The model has `Number` and with<S>(), the same arm computed with S. The compiler says what of
/// this is missing, at static_assert(ForRuns<E>) or at Runs<E>, but for what memory() leaves out:
/// bench/kit/conformance.h, which compares the runs of E, finds that.
#pragma once

#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <tuple>
#include <type_traits>
#include <utility>

#include "estimators/concepts.h"
#include "estimators/runs/numbers.h"
#include "estimators/runs/sampling_of_runs.h"

namespace tauext {

/// An estimator that can do several runs at once.
template <class E>
concept ForRuns = TorqueEstimator<E> && requires(E& e, const typename E::Model& model) {
  model.template with<Pack<4>>();
  requires std::same_as < typename E::template For<decltype(model.template with<Pack<4>>())>::Model,
  decltype(model.template with<Pack<4>>()) > ;
  { e.parameters() } -> std::convertible_to<typename E::Parameters>;
  e.memory();
  E(model, e.parameters());
  // no class that derives from one, and would be that one; nor a model that does
  requires std::same_as<typename E::template For<typename E::Model>, E>;
  requires std::same_as<decltype(model.template with<double>()), typename E::Model>;
};

/// The estimates of W runs of N joints.
template <int N, int W>
struct RunsEstimate {
  Vec<N, Pack<W>> tau_ext;               ///< [N m] as of Estimate
  std::array<Status, W> status{};        ///< of each run
  std::array<std::uint8_t, W> joints{};  ///< of each run
};

/// Makes y the sample of run i.
template <int N, int W>
void put(const Measurement<N>& y, int i, Measurement<N, Pack<W>>& all) noexcept {
  all.t.set(i, y.t);
  for (int j = 0; j < N; ++j) {
    all.q[j].set(i, y.q[j]);
    all.qd[j].set(i, y.qd[j]);
    all.tau[j].set(i, y.tau[j]);
  }
}

/// W runs of an estimator E: 4 or 8.
template <ForRuns E, int W = kRuns>
class Runs {
  static_assert(W == 4 || W == 8, "Runs<E, W> are 4 or 8 runs at once");

 public:
  static constexpr int kDof = E::kDof;
  using Model = typename E::Model;            ///< of doubles
  using Parameters = typename E::Parameters;  ///< of a run
  using Sample = Measurement<kDof, Pack<W>>;  ///< of all runs
  /// The same model of all runs.
  using ModelOfAll = decltype(std::declval<Model>().template with<Pack<W>>());

  /// Runs of different parameters.
  /// @throws std::invalid_argument for parameters out of range, and where runs differ in what is no
  /// number (a choice), or in max_gap or Ts
  Runs(const Model& model, const std::array<Parameters, W>& p)
      : Runs(model, model.template with<Pack<W>>(), p) {}
  /// Runs that differ in their samples alone.
  Runs(const Model& model, const Parameters& p) : Runs(model, repeated(p)) {}
  /// The same, where there is a better one of all runs: one that knows what comes, or remembers.
  Runs(const Model& model, const ModelOfAll& of_all, const Parameters& p)
      : Runs(model, of_all, repeated(p)) {}

  /// All runs forget everything.
  void reset() noexcept {
    for (int i = 0; i < W; ++i) reset(i);
  }
  /// Run i forgets everything.
  void reset(int i) noexcept {
    apart([&](int run) {
      if (run == i) one(run).reset();
    });
  }

  /// The next sample of each run.
  [[gnu::always_inline]] const RunsEstimate<kDof, W>& update(const Sample& y) noexcept {
    if (!(sampling().look(y) && step(y))) [[unlikely]]
      one_by_one(y);
    return estimate_;
  }

 private:
  using All = typename E::template For<ModelOfAll>;

  Runs(const Model& model, const ModelOfAll& of_all, const std::array<Parameters, W>& p)
      : one_(made(model, p, std::make_index_sequence<W>())),
        all_(of_all, detail::packed<typename All::Parameters>(p)) {
    reset();
  }

  E& one(int i) noexcept { return one_[static_cast<std::size_t>(i)]; }
  Sampling<kDof, Pack<W>>& sampling() noexcept { return std::get<0>(all_.memory()); }
  static auto everything(All& all) noexcept {
    using First = std::tuple_element_t<0, decltype(all.memory())>;
    static_assert(std::same_as<First, Sampling<kDof, Pack<W>>&>,
                  "memory() lists a Sampling<kDof, Scalar> first");
    return std::tuple_cat(std::get<0>(all.memory()).memory(), detail::rest(all.memory()));
  }

  // false where it is no ordinary one of all runs; nothing has changed then
  [[gnu::always_inline]] bool step(const Sample& y) noexcept {
    if (sampling().taken() == sampling().kSpan) keep();
    const Estimate<kDof, Pack<W>> e = all_.update(y);
    if (e.status != Status::kOk) [[unlikely]] {
      go_back();
      return false;
    }
    sampling().take(y);
    estimate_.tau_ext = e.tau_ext;
    estimate_.status.fill(Status::kOk);
    estimate_.joints.fill(0);
    return true;
  }

  // Most steps are never gone back to: it costs less to do a few again than to copy at each.
  void keep() noexcept {
    sampling().keep();
    kept_ = detail::values(everything(all_));
  }
  [[gnu::noinline]] void go_back() noexcept {
    const auto samples = sampling();
    sampling().keep();
    everything(all_) = kept_;
    for (int k = 1; k <= samples.taken(); ++k) {
      sampling().look(samples.sample(k));
      all_.update(samples.sample(k));
      sampling().take(samples.sample(k));
    }
  }

  [[gnu::noinline]] void one_by_one(const Sample& y) noexcept {
    apart([&](int i) {
      Measurement<kDof> mine;
      mine.t = y.t[i];
      for (int j = 0; j < kDof; ++j)
        mine.q[j] = y.q[j][i], mine.qd[j] = y.qd[j][i], mine.tau[j] = y.tau[j][i];
      const Estimate<kDof> e = one(i).update(mine);
      for (int j = 0; j < kDof; ++j) estimate_.tau_ext[j].set(i, e.tau_ext[j]);
      estimate_.status[static_cast<std::size_t>(i)] = e.status;
      estimate_.joints[static_cast<std::size_t>(i)] = e.joints;
    });
  }

  // calls f(i) while the estimator of run i is as far as that run
  template <class F>
  void apart(const F& f) noexcept {
    const bool settled = sampling().part();
    for (int i = 0; i < W; ++i) {
      auto& judges = std::get<0>(one(i).memory());
      detail::for_numbers(one(i), all_, [i](double& a, Pack<W>& b) { a = b[i]; });
      if (settled) judges.settle();
      f(i);
      detail::for_numbers(one(i), all_, [i](double& a, Pack<W>& b) { b.set(i, a); });
      if (judges.watches()) sampling().watch();
    }
    keep();
  }

  template <std::size_t... I>
  static std::array<E, W> made(const Model& model, const std::array<Parameters, W>& p,
                               std::index_sequence<I...>) {
    return {made(model, p[I], I)...};
  }
  static E made(const Model& model, const Parameters& p, std::size_t run) {
    try {
      return E(model, p);
    } catch (const std::invalid_argument& e) {
      throw std::invalid_argument("run " + std::to_string(run) + ": " + e.what());
    }
  }
  static std::array<Parameters, W> repeated(const Parameters& p) {
    std::array<Parameters, W> out;
    out.fill(p);
    return out;
  }

  std::array<E, W> one_;  // for samples that are not ordinary, and what these leave behind
  All all_;
  decltype(detail::values(everything(std::declval<All&>()))) kept_;  // before the steps since
  RunsEstimate<kDof, W> estimate_;
};

}  // namespace tauext
