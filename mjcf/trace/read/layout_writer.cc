// SPDX-License-Identifier: Apache-2.0
#include "mjcf/trace/read/layout_writer.h"

#include <fmt/format.h>

#include <cmath>
#include <stdexcept>
#include <vector>

#include "mjcf/trace/atomic_file.h"
#include "mjcf/trace/known.h"
#include "mjcf/trace/read/bag/bag_writer.h"

namespace tauext {
namespace {

// how a program writes its rows
struct Layout {
  const char* name;
  double begin;                     // [s] of its clock
  const char *q, *qd, *tau, *head;  // names, {} for the joint from 0
  char separator;
  const char* number;  // how it writes one
};

constexpr Layout kLayouts[] = {
    {"libfranka", 125, "state.q[{}]", "state.dq[{}]", "state.tau_J[{}]", "time,success_rate", ',',
     "{:.6g}"},
    {"ur_rtde", 4021.5, "actual_q_{}", "actual_qd_{}", "actual_current_{}", "timestamp", ' ', "{}"},
    {"joint_state", 1.7e9, "", "", "", "", ' ', ""}};

std::string csv_of(const Trace& t, const Layout& layout, const Eigen::MatrixXd& torque) {
  fmt::memory_buffer out;
  const auto to = std::back_inserter(out);
  fmt::format_to(to, "{}", layout.head);
  for (const char* name : {layout.q, layout.qd, layout.tau}) {
    for (int j = 0; j < t.dof(); ++j)
      fmt::format_to(to, "{}{}", layout.separator, fmt::format(fmt::runtime(name), j));
  }
  if (!t.contact.empty()) fmt::format_to(to, "{}contact", layout.separator);
  const bool milliseconds = layout.name == std::string_view("libfranka");
  for (int k = 0; k < t.size(); ++k) {
    const double clock = layout.begin + t.t[static_cast<std::size_t>(k)];
    fmt::format_to(to, "\n");
    if (milliseconds) {
      fmt::format_to(to, "{},1", std::llround(1e3 * clock));
    } else {
      fmt::format_to(to, "{:.3f}", clock);
    }
    for (const Eigen::MatrixXd* m : {&t.q, &t.qd, &torque}) {
      for (int j = 0; j < t.dof(); ++j) {
        const double x = std::round((*m)(j, k) * 1e7) / 1e7;  // more no sensor knows
        fmt::format_to(to, "{}{}", layout.separator, fmt::format(fmt::runtime(layout.number), x));
      }
    }
    if (!t.contact.empty())
      fmt::format_to(to, "{}{}", layout.separator, int{t.contact[static_cast<std::size_t>(k)]});
  }
  fmt::format_to(to, "\n");
  return fmt::to_string(out);
}

}  // namespace

void write_layout(const Trace& t, const std::string& layout, const Eigen::VectorXd& gain,
                  std::vector<std::string> joints, const std::string& path) {
  const Layout& l = find_known(kLayouts, "layout", layout, [](const Layout& x) { return x.name; });
  Eigen::MatrixXd torque = t.tau;
  if (layout == "ur_rtde") {
    if (gain.size() != t.dof() || (gain.array() == 0).any())
      throw std::invalid_argument(
          "the layout ur_rtde has currents: a robot file (.json) must say the `gain` of each "
          "drive");
    torque = gain.cwiseInverse().asDiagonal() * t.tau;
  }
  for (int j = static_cast<int>(joints.size()); j < t.dof(); ++j)
    joints.push_back(fmt::format("joint{}", j + 1));
  const std::string bytes =
      layout == "joint_state" ? bag_of(t, joints, l.begin) : csv_of(t, l, torque);
  AtomicFile file(path);
  file.write(bytes);
  file.commit();
}

}  // namespace tauext
