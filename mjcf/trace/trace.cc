// SPDX-License-Identifier: Apache-2.0
#include "mjcf/trace/trace.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "mjcf/trace/atomic_file.h"

namespace tauext {
namespace {

constexpr const char* kVectors[] = {"q", "qd", "tau", "tau_ext"};
constexpr const char* kAtInstants = "tau_instant";  // instead of tau

}  // namespace

Trace select_samples(const Trace& trace, const std::vector<int>& samples) {
  Trace s = trace;
  const auto of_vector = [&](auto& v) {
    if (v.empty()) return;
    for (std::size_t i = 0; i < samples.size(); ++i) v[i] = v[samples[i]];
    v.resize(samples.size());
  };
  of_vector(s.t);
  of_vector(s.contact);
  of_vector(s.contact_force);
  for (auto* m : {&s.q, &s.qd, &s.tau, &s.tau_ext, &s.tau_ext_of_driver, &s.qdd, &s.friction,
                  &s.motor_q, &s.motor_qd}) {
    if (m->cols() > 0) *m = Eigen::MatrixXd((*m)(Eigen::indexing::all, samples));
  }
  if (s.force.cols() > 0) s.force = Eigen::Matrix3Xd(trace.force(Eigen::indexing::all, samples));
  const auto stop = std::lower_bound(samples.begin(), samples.end(), trace.stopped_at);
  if (trace.stopped_at >= 0) s.stopped_at = static_cast<int>(stop - samples.begin());
  return s;
}

void require_gains(const Eigen::VectorXd& gain, int joints) {
  if (joints != gain.size())
    throw std::invalid_argument(
        fmt::format("the log has {} joints, and the robot {}", joints, gain.size()));
  for (Eigen::Index i = 0; i < gain.size(); ++i) {
    if (gain[i] != 0) continue;
    throw std::invalid_argument(fmt::format(
        "the log has currents, and nobody knows the gain of drive {} [N m/A]: it stands in the map "
        "of columns, or in a robot file, where tauext-calibrate writes it",
        i + 1));
  }
}

void make_torques(Trace& trace, const Eigen::VectorXd& gain) {
  if (!trace.tau_is_current) return;
  require_gains(gain, trace.dof());
  trace.tau = gain.asDiagonal() * trace.tau;
  trace.tau_is_current = false;
}

void write_csv(const Trace& trace, const std::string& path) {
  const Eigen::MatrixXd* const matrices[] = {&trace.q, &trace.qd, &trace.tau, &trace.tau_ext};
  AtomicFile file(path);
  fmt::memory_buffer out;
  const auto to = std::back_inserter(out);
  fmt::format_to(to, "t");
  for (int m = 0; m < 4; ++m) {
    if (matrices[m]->cols() == 0) continue;
    const bool instants = matrices[m] == &trace.tau && trace.torque_at_instants;
    for (int j = 1; j <= trace.dof(); ++j) {
      fmt::format_to(to, ",{}{}", instants ? kAtInstants : kVectors[m], j);
    }
  }
  fmt::format_to(to, "{}\n", trace.contact.empty() ? "" : ",contact");
  for (int k = 0; k < trace.size(); ++k) {
    fmt::format_to(to, "{:.17g}", trace.t[k]);
    for (const Eigen::MatrixXd* m : matrices) {
      if (m->cols() == 0) continue;
      for (int j = 0; j < trace.dof(); ++j) fmt::format_to(to, ",{:.17g}", (*m)(j, k));
    }
    if (!trace.contact.empty()) fmt::format_to(to, ",{}", int{trace.contact[k]});
    fmt::format_to(to, "\n");
    if (out.size() > 1 << 16) {
      file.write({out.data(), out.size()});
      out.clear();
    }
  }
  file.write({out.data(), out.size()});
  file.commit();
}

}  // namespace tauext
