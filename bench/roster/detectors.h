// SPDX-License-Identifier: Apache-2.0
/// @file
/// Detectors behind one virtual call for a batch of samples, of arms of any number of joints, and
/// how a specification becomes one. The list of them is detector_list.h.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "bench/roster/specification.h"
#include "bench/roster/thresholds.h"
#include "estimators/concepts.h"
#include "estimators/detectors/marking.h"
#include "estimators/math/pack.h"
#include "estimators/samples/columns.h"

namespace tauext {

/// What a detector sees; with a Pack for Scalar, of several runs.
template <class Scalar = double>
struct DetectorInput {
  SampleColumns<Scalar> samples;    ///< of the arm
  const Scalar* tau_ext = nullptr;  ///< [N m] as many estimates, likewise
  const Status* status = nullptr;   ///< of the estimates of one run

  /// [rad/s] of sample k.
  JointVecView<Scalar> qd(std::size_t k) const { return column(samples.qd, k); }
  /// [N m]
  JointVecView<Scalar> tau(std::size_t k) const { return column(samples.tau, k); }
  /// [N m]
  JointVecView<Scalar> estimate(std::size_t k) const { return column(tau_ext, k); }

 private:
  JointVecView<Scalar> column(const Scalar* of, std::size_t k) const {
    return {of + k * static_cast<std::size_t>(samples.joints), samples.joints};
  }
};

/// A detector, type-erased; with a Pack for Scalar, of several runs of one clock, of whose
/// estimates all are used().
template <class Scalar = double>
class DetectorStage {
 public:
  virtual ~DetectorStage() = default;
  virtual void reset() = 0;  ///< forgets all samples
  /// What is detected at each sample.
  virtual void run(const DetectorInput<Scalar>& in, std::span<DetectionOf<Scalar>> out) = 0;
  /// Of the last sample; empty for a detector that cannot be calibrated.
  virtual JointVec<Scalar> statistic() const = 0;
  /// What its metric weighs; empty for a detector without one.
  virtual JointVec<Scalar> change() const = 0;
};

/// The stage of this detector, which computes with Scalar.
template <class D, class Scalar = double>
class DetectorStageOf final : public DetectorStage<Scalar> {
 public:
  explicit DetectorStageOf(D d) : d_(std::move(d)) {}  ///< takes it over
  void reset() override { d_.reset(); }
  /// As DetectorStage says.
  void run(const DetectorInput<Scalar>& in, std::span<DetectionOf<Scalar>> out) override {
    for (std::size_t k = 0; k < in.samples.size; ++k) {
      if constexpr (std::is_same_v<Scalar, double>) {
        if (!used(in.status[k])) {  // as detect() behind an estimator
          if (in.status[k] == Status::kDiverged) d_.reset();
          out[k] = {};
          continue;
        }
      }
      out[k] = detect<Scalar>(d_, in.samples.t[k], in.qd(k), in.tau(k), in.estimate(k));
    }
  }
  JointVec<Scalar> statistic() const override {
    if constexpr (requires { d_.statistic(); }) {
      return d_.statistic();
    } else {
      return {};
    }
  }
  JointVec<Scalar> change() const override {
    if constexpr (requires { d_.change(); }) {
      return d_.change();
    } else {
      return {};
    }
  }

 private:
  D d_;
};

/// What calibrating a detector needs to know.
struct Calibration {
  int degree = 1;             ///< power of tau_ext that its statistic grows with
  Eigen::VectorXd threshold;  ///< its default, in the unit of its statistic
  bool has_metric = false;    ///< whether it weighs the joints by a metric, too
};

namespace detail {

// a detector whose thresholds another one takes, and what stands before its keys there
struct TrainedPart {
  std::string name, prefix;
};

// sets what is known of Parameters p, which have a value for each joint
template <class P>
void set_trained(P& p, const char* name, const DetectorThresholds& known) {
  const auto it = known.find(name);
  if (it == known.end()) return;
  const int joints = static_cast<int>(p.threshold.size());
  const auto& [threshold, metric] = it->second;
  if (threshold.size() != joints) fail_joints("threshold", name, threshold.size(), joints);
  p.threshold = threshold;
  if constexpr (requires { p.metric; }) {
    if (metric.size() == 0) return;
    if (metric.rows() != joints || metric.cols() != joints)
      fail_joints("metric", name, metric.rows(), joints);
    p.metric = metric;
  }
}

// one that is made of two others is trained as they are
template <class D>
concept OfTrainedParts = requires(typename D::Parameters p) {
  p.collision.threshold;
  p.clamping.threshold;
};

constexpr const char *kFindsBlows = "pan_tompkins", *kFindsClampings = "clamping";

// Defaults with a value for each joint, times its factor where they are in N m: squared for
// (N m)^2. Where a metric mixes the joints, it makes them comparable, and its threshold is that of
// as many.
template <class P>
void scale_torques(P& p, const JointVec<>& factor) {
  for_each_field<P>([&](const auto& f) {
    auto& x = p.*f.at;
    if constexpr (!requires { f.unit; }) {
      scale_torques(x, factor);
    } else if constexpr (requires { x.size(); }) {
      static_assert(std::is_same_v<decltype(x), JointVec<>&>, "of detectors, a JointVec<>");
      if (x.size() == 1) x = JointVec<>::Constant(factor.size(), x[0]);
      const std::string_view unit = f.unit;
      if (unit.starts_with("N m")) x = x.cwiseProduct(factor).eval();
      if (unit.starts_with("(N m")) x = x.cwiseProduct(factor.cwiseAbs2()).eval();
    }
  });
  if constexpr (requires { p.metric; }) {
    if ((factor.array() == 1).all()) return;
    const JointVec<> even = factor.maxCoeff() * factor.cwiseInverse();
    p.metric = even.cwiseAbs2().asDiagonal();  // of an identity
    p.threshold =
        (p.threshold.cwiseProduct(even) * std::sqrt(static_cast<double>(even.size()) / 3)).eval();
  }
}

// an arm's defaults
template <class D>
typename D::Parameters defaults_for(const JointVec<>& torques) {
  typename D::Parameters p;
  if constexpr (ListsFields<typename D::Parameters>) scale_torques(p, torques);
  return p;
}

// the arm's defaults, then what training says, then what the specification says
template <class D>
D made_detector(const Specification& s, const DetectorSettings& settings,
                const JointVec<>& torques) {
  const int joints = static_cast<int>(torques.size());
  if constexpr (requires { typename D::Parameters; }) {
    typename D::Parameters p = defaults_for<D>(torques);
    if constexpr (OfTrainedParts<D>) {
      set_trained(p.collision, kFindsBlows, settings.thresholds);
      set_trained(p.clamping, kFindsClampings, settings.thresholds);
      p.collision.start_up = p.clamping.start_up = settings.start_up;
    } else {
      if constexpr (requires { p.threshold; }) set_trained(p, D::kName, settings.thresholds);
      if constexpr (requires { p.start_up; }) p.start_up = settings.start_up;
      if constexpr (requires { p.most_score; })
        p.most_score = settings.most_score.value_or(p.most_score);
    }
    set_parameters(s.keys, p);
    return D(joints, p);
  } else {
    refuse_keys(s);
    if constexpr (std::is_default_constructible_v<D>)  // of which an int may be a parameter
      return D();
    else
      return D(joints);
  }
}

}  // namespace detail

/// A detector of an arm, by name.
struct DetectorType {
  std::string name;                                ///< as specifications have it
  std::vector<FieldHelp> fields;                   ///< what a specification sets
  std::vector<detail::TrainedPart> trained_parts;  ///< the detectors whose thresholds it takes
  std::optional<Calibration> calibration;          ///< how they are set
  /// Builds one: the arm's defaults, then what training says, then what the specification says.
  std::unique_ptr<DetectorStage<>> (*make)(const Specification& s, const DetectorSettings& settings,
                                           const JointVec<>& torques) = nullptr;
};

/// The type of detector D.
/// @param torques [1] factor of each joint on the torques of detectors' defaults
template <CollisionDetector D>
DetectorType detector_type(const JointVec<>& torques) {
  DetectorType type;
  type.name = D::kName;
  if constexpr (requires { typename D::Parameters; }) {
    const typename D::Parameters p = detail::defaults_for<D>(torques);
    type.fields = field_help(&p);
    if constexpr (detail::OfTrainedParts<D>) {
      type.trained_parts = {{detail::kFindsBlows, "collision."},
                            {detail::kFindsClampings, "clamping."}};
    } else if constexpr (CalibratableDetector<D>) {
      constexpr bool kMetric = requires(D d) {
        p.metric, d.change();
      };
      type.trained_parts = {{D::kName, ""}};
      type.calibration = Calibration{D::kDegree, p.threshold, kMetric};
    }
  }
  type.make = [](const Specification& s, const DetectorSettings& settings,
                 const JointVec<>& of_arm) -> std::unique_ptr<DetectorStage<>> {
    return std::make_unique<DetectorStageOf<D>>(detail::made_detector<D>(s, settings, of_arm));
  };
  return type;
}

namespace detail {

// those of detector_list.h
std::vector<DetectorType> roster_detectors(const JointVec<>& torques);

// of W runs at once; null for one that is not of the list. W is in its name: code with other flags
// has another one
template <int W>
std::unique_ptr<DetectorStage<Pack<W>>> detector_of_runs(const Specification& s,
                                                         const DetectorSettings& settings,
                                                         const JointVec<>& torques);
template <>
std::unique_ptr<DetectorStage<Pack<kRuns>>> detector_of_runs<kRuns>(
    const Specification& s, const DetectorSettings& settings, const JointVec<>& torques);

}  // namespace detail
}  // namespace tauext
