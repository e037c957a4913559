// SPDX-License-Identifier: Apache-2.0
#include "bench/roster/baselines.h"

#include <algorithm>
#include <cstddef>
#include <memory>
#include <utility>

namespace tauext {
namespace {

constexpr std::string_view kZero = "zero", kTruth = "truth", kDelayedTruth = "delayed_truth";
constexpr Eigen::Index kDelay = 10;  // samples

// columns of a matrix, so many samples late; 0 where there are none
class Copy final : public EstimatorStage<> {
 public:
  Copy(int joints, Eigen::MatrixXd columns, Eigen::Index delay)
      : EstimatorStage<>(joints), columns_(std::move(columns)), delay_(delay) {}

  void reset() override { next_ = 0; }
  void run(const SampleColumns<>& in, const EstimateColumns<>& out) override {
    std::fill_n(out.status, in.size, Status::kOk);
    std::fill_n(out.of_joints, in.size, std::uint8_t{0});
    for (std::size_t i = 0; i < in.size; ++i) {
      const Eigen::Index k = next_++ - delay_;
      Eigen::Map<Eigen::VectorXd> to(out.tau_ext + i * static_cast<std::size_t>(joints()),
                                     joints());
      if (k >= 0 && k < columns_.cols())
        to = columns_.col(k);
      else
        to.setZero();
    }
  }

 private:
  Eigen::MatrixXd columns_;
  Eigen::Index delay_, next_ = 0;
};

}  // namespace

std::vector<EstimatorType> baseline_types(int joints) {
  const auto type = [joints](std::string_view name, bool copies_truth, Eigen::Index delay) {
    EstimatorType t{.name = std::string(name), .copies_truth = copies_truth};
    t.make = [=](const Specification& s, const Trace& trace) -> std::unique_ptr<EstimatorStage<>> {
      detail::refuse_keys(s);
      return std::make_unique<Copy>(joints, copies_truth ? trace.tau_ext : Eigen::MatrixXd(),
                                    delay);
    };
    return t;
  };
  return {type(kZero, false, 0), type(kTruth, true, 0), type(kDelayedTruth, true, kDelay)};
}

bool needs_truth(std::string_view estimator) {
  const std::string_view name = name_of_specification(estimator);
  return name == kTruth || name == kDelayedTruth;
}

bool is_baseline(std::string_view estimator) {
  return name_of_specification(estimator) == kZero || needs_truth(estimator);
}

}  // namespace tauext
