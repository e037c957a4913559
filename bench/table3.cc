// SPDX-License-Identifier: Apache-2.0
#include "bench/table3.h"

#include <fmt/format.h>

#include "bench/metrics.h"
#include "bench/stages.h"
#include "estimators/ekf.h"
#include "estimators/ndob.h"
#include "estimators/wallmobot3.h"
#include "mjcf/record.h"

namespace tauext {
namespace {

template <class E>
std::array<StepResponse, 3> responses(const Trace& trace, const E& estimator) {
  RunnerOf<3> runner(std::make_unique<EstimatorStageOf<E>>(estimator), nullptr, trace);
  const Output out = runner.run();
  std::array<StepResponse, 3> r;
  for (int j = 0; j < 3; ++j)
    r[j] = step_response(trace.t, trace.tau_ext.row(j), out.tau_ext.row(j));
  return r;
}

void append(std::string& out, const char* title, const std::vector<Table3Row>& rows) {
  out += fmt::format("  {}\n", title);
  for (const Table3Row& r : rows) {
    out += fmt::format("    {:<18} {:>8.3f} {:>7.3f} {:>7.3f}   {:>8.3f} {:>7.3f} {:>7.3f}\n",
                       r.quantity, r.ekf[0], r.ekf[1], r.ekf[2], r.ndob[0], r.ndob[1], r.ndob[2]);
  }
}

}  // namespace

std::vector<Table3Row> table3_printed() {
  return {{"rise", {0.18, 0.49, 0.44}, {0.145, 0.925, 0.619}},
          {"settling, 2 %", {0.61, 0.52, 0.35}, {0.06, 0.22, 0.19}}};
}

std::vector<Table3Row> table3_measured(double panel) {
  const WallMoBot3 model(WallMoBot3::Parameters::with_panel(panel));
  const Trace trace = record(wallmobot3_with_panel(panel), scenario("wallmobot3", "step"));
  using EkfOfArm = Ekf<WallMoBot3>;
  using NdobOfArm = Ndob<WallMoBot3>;
  const auto ekf = responses(trace, EkfOfArm(model, EkfOfArm::Parameters::paper()));
  const auto ndob = responses(trace, NdobOfArm(model, NdobOfArm::Parameters::paper()));
  const auto row = [&](const char* quantity, double StepResponse::*value) {
    return Table3Row{quantity,
                     {ekf[0].*value, ekf[1].*value, ekf[2].*value},
                     {ndob[0].*value, ndob[1].*value, ndob[2].*value}};
  };
  return {row("rise, 10-90 %", &StepResponse::rise), row("rise, 0-90 %", &StepResponse::rise_0_90),
          row("settling, 2 %", &StepResponse::settling)};
}

std::string format_table3() {
  std::string out =
      "Table III of the paper beside ours: step of 98.2 N m, times in s, joints 2, 3, 4\n"
      "                                 EKF                        NDOB\n";
  append(out, "the paper", table3_printed());
  append(out, "measured, arm of Table II (panel 150 kg)", table3_measured(150));
  append(out, "measured, no panel (m_5 = 27 kg)", table3_measured(0));
  out +=
      "  They cannot agree: the printed rise times exceed the settling times (NDOB on every joint, "
      "EKF\n"
      "  on joint 4), which no single signal can do. The NDOB's printed rise is near our 0-90 % "
      "with\n"
      "  the panel, its printed settling only near ours without it; no reading reproduces the "
      "EKF's.\n"
      "  So nothing here is gated on Table III.\n";
  return out;
}

}  // namespace tauext
