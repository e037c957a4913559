// SPDX-License-Identifier: Apache-2.0
#include "bench/calibrate/masses/mass_report.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Eigenvalues>
#include <cstddef>
#include <vector>

#include "mjcf/import/masses/body_masses.h"
#include "mjcf/trace/printable.h"

namespace tauext {
namespace {

std::string four_digits(double x) {
  return fmt::format("{:.4g}", x);
}

// what of the base parameters was shown, and of which bodies some were not
std::string shown(const IdentifiedMasses& m) {
  std::string words = fmt::format(
      "Torques can show {} combinations of these numbers (base parameters); the recordings show {} "
      "of them, with a standard error below a tenth of what the bodies have.\n",
      m.base.all, m.base.shown);
  std::vector<std::string> missing;
  for (std::size_t b = 0; b < m.bodies.size(); ++b)
    if (const double n = m.base.missing[static_cast<Eigen::Index>(b)]; n >= 0.5)
      missing.push_back(fmt::format("{:.0f} of {}", n, printable_name(m.bodies[b].name)));
  if (!missing.empty())
    words +=
        fmt::format("Not shown: {}. There the numbers stay near {}.\n", fmt::join(missing, ", "),
                    m.has_nominal ? "those of the file"
                                  : "those of rods from joint to joint, as the file has none");
  return words;
}

}  // namespace

std::string body_table(const IdentifiedMasses& m, TableFormat format) {
  TableWriter table({{"body", "", true},
                     {"mass", "kg"},
                     {"in the file", "kg"},
                     {"center x", "m"},
                     {"center y", "m"},
                     {"center z", "m"},
                     {"least moment", "kg m^2"},
                     {"middle", "kg m^2"},
                     {"largest", "kg m^2"}});
  for (const IdentifiedBody& b : m.bodies) {
    const MeasuredBody& found = b.identified;
    const Eigen::Vector3d I =
        Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(detail::tensor(found)).eigenvalues();
    table.add({printable_name(b.name), four_digits(found.mass),
               b.known ? four_digits(b.file.mass) : "", four_digits(found.center[0]),
               four_digits(found.center[1]), four_digits(found.center[2]), four_digits(I[0]),
               four_digits(I[1]), four_digits(I[2])});
  }
  return table.format(format);
}

std::string mass_report(const IdentifiedMasses& m) {
  TableWriter table({{"joint", "", true},
                     {"torque", "N m rms"},
                     {"file's masses", "N m rms"},
                     {"these masses", "N m rms"},
                     {"gravity", "+- N m"},
                     {"inertia", "+- kg m^2"}});
  for (const JointOfMasses& j : m.joints)
    table.add({j.name, four_digits(j.torque), m.has_nominal ? four_digits(j.nominal) : "",
               four_digits(j.held_out), fmt::format("{:.2g}", j.gravity_error),
               fmt::format("{:.2g}", j.inertia_error)});
  return table.format() +
         "\nMasses leave that much of the torque, with friction that fits them, in stretches that "
         "the fit has not seen;\ngravity and inertia are one standard error of the torque that "
         "holds "
         "a joint, and of what it turns, in poses of all of its range.\n" +
         shown(m) +
         "No single mass, center or inertia is known by this, and none has an error here: others "
         "that make the same torques are as good.\n"
         "What no motion without contact can tell: f times all torques from f times all masses, "
         "friction and rotors.\n";
}

}  // namespace tauext
