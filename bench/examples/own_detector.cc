// SPDX-License-Identifier: Apache-2.0
// A detector of your own: marks where tau_ext has jumped within the last two samples. Run
//   own_detector --benchmark_filter=wallmobot3/collision/     it is the rows "...+jump"
#include "bench/bench_main.h"
#include "bench/registry.h"
#include "estimators/detectors/marking.h"

struct Jump {
  static constexpr const char* kName = "jump";

  void reset() noexcept { *this = Jump(); }

  tauext::Detection update(double t, const tauext::JointVecView<>& tau_ext) noexcept {
    if (!marking.accept(t)) return marking.held();
    if (marking.silent(t)) before = last = tau_ext;                // the first sample
    const double jump = (tau_ext - before).cwiseAbs().maxCoeff();  // [N m]
    before = last;
    last = tau_ext;
    return marking(t, jump / 3, tauext::Contact::kCollision);  // 3 N m within 2 ms
  }

  tauext::Marking marking{0.2, 0};
  tauext::JointVec<> last, before;
};

int main(int argc, char** argv) {
  tauext::register_detector<Jump>();
  return tauext::bench_main(argc, argv);
}
