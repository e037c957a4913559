// SPDX-License-Identifier: Apache-2.0
#include "bench/peers/kdl_module.h"

#include <memory>
#include <string_view>
#include <utility>

#include "bench/peers/observers.h"
#include "bench/peers/textbook_ekf.h"
#include "bench/roster/estimators.h"

namespace tauext::peers {
namespace {

// the EKF of the textbook on KDL's dynamics
template <int N>
struct KdlEkf : TextbookEkf<double, KdlArm<N>> {
  static constexpr const char* kName = "kdl_ekf";
  using TextbookEkf<double, KdlArm<N>>::TextbookEkf;
};

template <int N>
KdlArm<N> arm_of(const void* arm) {
  return KdlArm<N>(TreeModel<N>(*static_cast<const typename TreeModel<N>::Parameters*>(arm)));
}

template <int N>
EstimatorStage<>* stage(std::string_view kind, const void* arm, const void* ekf, double w) {
  const KdlArm<N> kdl = arm_of<N>(arm);
  const auto of = [](auto e) -> EstimatorStage<>* {
    return new EstimatorStageOf<decltype(e)>(std::move(e));
  };
  if (kind == KdlEkf<N>::kName)
    return of(KdlEkf<N>(*static_cast<const EkfParameters<N>*>(ekf), kdl));
  if (kind == KdlNdob<N>::kName) return of(KdlNdob<N>(kdl, w));
  if (kind == KdlMomentumObserver<N>::kName) return of(KdlMomentumObserver<N>(kdl, w));
  if (kind == KdlWrenchEstimator<N>::kName) return of(KdlWrenchEstimator<N>(kdl, w, 1e-3));
  return nullptr;
}

template <int N>
void terms(const void* arm, const double* q, const double* qd, double* B, double* bias) {
  const KdlArm<N> kdl = arm_of<N>(arm);
  const Vec<N> at = Vec<N>::Map(q), rate = Vec<N>::Map(qd);
  Mat<N>::Map(B) = kdl.inertia(at);
  Vec<N>::Map(bias) = kdl.coriolis(at, rate) + kdl.gravity(at);
}

}  // namespace
}  // namespace tauext::peers

extern "C" {

[[gnu::visibility("default")]] void* tauext_kdl_make_stage(int n, const char* kind, const void* arm,
                                                           const void* ekf, double w) {
  using namespace tauext::peers;
  switch (n) {
    case 3:
      return stage<3>(kind, arm, ekf, w);
    case 6:
      return stage<6>(kind, arm, ekf, w);
    case 7:
      return stage<7>(kind, arm, ekf, w);
    default:
      return nullptr;
  }
}

[[gnu::visibility("default")]] bool tauext_kdl_terms(int n, const void* arm, const double* q,
                                                     const double* qd, double* B, double* bias) {
  using namespace tauext::peers;
  switch (n) {
    case 3:
      return terms<3>(arm, q, qd, B, bias), true;
    case 6:
      return terms<6>(arm, q, qd, B, bias), true;
    case 7:
      return terms<7>(arm, q, qd, B, bias), true;
    default:
      return false;
  }
}

}  // extern "C"
