// SPDX-License-Identifier: Apache-2.0
/// @file
/// Estimators behind one virtual call for a batch of samples, of arms of any number of joints, and
/// by name. The list of them is roster.h.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "bench/roster/specification.h"
#include "estimators/concepts.h"
#include "estimators/math/pack.h"
#include "estimators/samples/columns.h"
#include "estimators/tree/run_terms.h"
#include "mjcf/trace/trace.h"

namespace tauext {

/// The columns of a trace, which must outlive them.
inline SampleColumns<> columns_of(const Trace& trace) {
  return {trace.dof(),     static_cast<std::size_t>(trace.size()),
          trace.t.data(),  trace.q.data(),
          trace.qd.data(), trace.tau.data()};
}

/// An estimator, type-erased; with a Pack for Scalar, of several runs.
template <class Scalar = double>
class EstimatorStage {
 public:
  explicit EstimatorStage(int joints) : joints_(joints) {}  ///< of so many
  virtual ~EstimatorStage() = default;
  int joints() const { return joints_; }  ///< of the arm
  virtual void reset() = 0;               ///< forgets all samples
  /// An estimate of each sample.
  virtual void run(const SampleColumns<Scalar>& in, const EstimateColumns<Scalar>& out) = 0;

 private:
  int joints_;
};

/// The stage of this estimator; of Runs of one, with their Scalar.
template <class E, class Scalar = double>
class EstimatorStageOf final : public EstimatorStage<Scalar> {
 public:
  /// Takes it over.
  explicit EstimatorStageOf(E e) : EstimatorStage<Scalar>(E::kDof), e_(std::move(e)) {}
  /// Of E(of...).
  template <class... Of>
  explicit EstimatorStageOf(std::in_place_t, const Of&... of)
      : EstimatorStage<Scalar>(E::kDof), e_(of...) {}
  void reset() override { e_.reset(); }
  /// As EstimatorStage says.
  void run(const SampleColumns<Scalar>& in, const EstimateColumns<Scalar>& out) override {
    for (std::size_t k = 0; k < in.size; ++k) {
      const auto& e = e_.update(in.template at<E::kDof>(k));
      Vec<E::kDof, Scalar>::Map(out.tau_ext + k * E::kDof) = e.tau_ext;
      out.status[k] = e.status;
      out.of_joints[k] = e.joints;
    }
  }

 private:
  E e_;
};

/// The terms of one arm at the samples of several runs, for the estimators that may share them.
class SharedTerms {
 public:
  using Lanes = Pack<kRuns>;                                              ///< of the runs
  explicit SharedTerms(const SampleColumns<Lanes>& in) : samples_(in) {}  ///< must outlive it
  /// Those of N joints, always the same N.
  template <int N>
  RunTerms<N, Lanes>& of() {
    if (!terms_) terms_ = std::make_shared<RunTerms<N, Lanes>>(samples_);
    return *static_cast<RunTerms<N, Lanes>*>(terms_.get());
  }

 private:
  SampleColumns<Lanes> samples_;
  std::shared_ptr<void> terms_;
};

/// An estimator of an arm, by name.
struct EstimatorType {
  using Lanes = Pack<kRuns>;  ///< of as many runs

  std::string name;                    ///< as specifications have it
  std::vector<FieldHelp> fields = {};  ///< what a specification sets
  bool tunable = false;                ///< whether `bandwidth` is one of them
  bool copies_truth = false;           ///< of the trace
  /// Builds one: the list's parameters, as the trace's torques want them (held, or read at
  /// instants), then what the specification says.
  std::function<std::unique_ptr<EstimatorStage<>>(const Specification&, const Trace&)> make = {};
  /// The same of several runs, whose torques are as the trace's; empty where it cannot.
  /// @param terms null, or of these runs
  std::function<std::unique_ptr<EstimatorStage<Lanes>>(const Specification&, const Trace&,
                                                       SharedTerms* terms)>
      make_runs = {};
};

/// [rad/s] of the estimators whose bandwidth is ours to choose: they are comparable with each
/// other.
inline constexpr double kRosterBandwidth = 30;

/// A line of the list: E over the model of a robot, with parameters that a specification changes.
template <class E, RobotModel M>
struct RosterEntry {
  M model;                            ///< of the robot, or what this one takes it for
  typename E::Parameters parameters;  ///< unless a specification changes them
  /// Builds one.
  E operator()() const { return E(model, parameters); }
};

/// Its type: estimator_type.h, which the estimator's own source compiles for the arms of the
/// library.
template <class E, RobotModel M>
EstimatorType roster_type(const RosterEntry<E, M>& entry);

}  // namespace tauext
