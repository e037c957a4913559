// SPDX-License-Identifier: Apache-2.0
#include "bench/calibrate/calibration_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "mjcf/trace/known.h"
#include "mjcf/trace/printable.h"

namespace tauext {
namespace {

std::string number(double x) {
  return fmt::format("{:.4g}", x);
}

// a sentence for each
std::string missing(const std::vector<Suspect>& all, const std::string& where) {
  std::string out;
  for (const Suspect& s : all) {
    out += fmt::format(
        "{}Missing? {} would explain {:.0f} % of the residuals' variance ({:.0f} standard "
        "errors).\n",
        where, s.name, 100 * s.share, s.surely);
  }
  if (!all.empty()) out += where + "The errors above do not know of what is missing.\n";
  return out;
}

// those whose torques and masses disagree
std::string scales_off_one(const std::vector<CalibratedJoint>& joints) {
  constexpr double kClear = 0.05;  // [1]
  std::string off;
  for (const CalibratedJoint& j : joints)
    if (j.scale != 0 && std::abs(j.scale - 1) > std::max(kClear, kSurely * j.scale_error))
      off += fmt::format("{}{} {:.3f}", off.empty() ? "" : ", ", printable_name(j.name), j.scale);
  if (off.empty()) return "";
  return fmt::format(
      "Measured torques and masses disagree by a factor, the torque scale: {}.\nEither the sensors "
      "say 1/scale of what they should, which --apply puts right, or the masses are wrong "
      "(--masses "
      "finds them).\n",
      off);
}

}  // namespace

std::string parameter_table(const std::vector<CalibratedJoint>& joints, TableFormat format) {
  TableWriter table({{"joint", "", true},
                     {"term", "", true},
                     {"unit", "", true},
                     {"estimate"},
                     {"std error"},
                     {"excitation", "rms"},
                     {"own share"}});
  for (const CalibratedJoint& j : joints) {
    std::string name = printable_name(j.name);
    const auto add = [&](const std::string& term, const char* unit, double value, double error,
                         const std::string& excitation, const std::string& own) {
      table.add({format == TableFormat::kText ? std::exchange(name, "") : name, term, unit,
                 number(value), fmt::format("{:.2g}", error), excitation, own});
    };
    if (j.gain != 0)
      add(j.of_currents ? "gain" : "torque_gain", j.of_currents ? "N m/A" : "1",
          j.gain * j.gain_before, std::abs(j.gain_error * j.gain_before), "", "");
    for (const CalibratedTerm& t : j.terms) {
      const JointTerm& known =
          find_known(kJointTerms, "term", t.name, [](const JointTerm& k) { return k.name; });
      add(t.name, known.unit, t.value, t.error, number(t.excitation), fmt::format("{:.3f}", t.own));
    }
  }
  return table.format(format);
}

std::string fit_report(const std::vector<CalibratedJoint>& joints) {
  TableWriter table({{"joint", "", true},
                     {"torque", "N m rms"},
                     {"masses", "N m rms"},
                     {"without", "N m rms"},
                     {"with", "N m rms"},
                     {"held out", "N m rms"},
                     {"windows"},
                     {"left out"},
                     {"torque scale"},
                     {"std error"}});
  std::string sentences;
  bool unseen = false, currents = false;
  for (const CalibratedJoint& j : joints) {
    const bool seen = j.scale != 0;
    table.add({printable_name(j.name), number(j.torque), number(j.rigid), number(j.before),
               number(j.after), number(j.held_out), fmt::format("{}", j.windows),
               fmt::format("{}", j.left_out),
               j.gain != 0 && !seen ? "gain"
               : seen               ? fmt::format("{:.3f}", j.scale)
                                    : "unseen",
               !seen ? "" : fmt::format("{:.2g}", j.scale_error)});
    unseen = unseen || (j.gain == 0 && !seen);
    currents = currents || (j.gain != 0 && j.of_currents);
    sentences += missing(j.missing, printable_name(j.name) + ": ");
  }
  sentences += scales_off_one(joints);
  sentences +=
      "What no motion without contact can tell: f times all torques from f times all masses, "
      "friction and rotors.\nIf the masses are wrong by a factor, so are the ";
  sentences +=
      currents ? "gains, friction and every estimate" : "torque scale above and every estimate";
  sentences += ", by the same; a known payload shows it (--weigh).\n";
  const bool all_unseen = std::all_of(joints.begin(), joints.end(), [](const CalibratedJoint& j) {
    return j.gain == 0 && j.scale == 0;
  });
  if (all_unseen && !joints.empty())
    sentences +=
        "The masses take next to nothing of any joint's torque: are torques in N m, and currents "
        "in A?\n";
  if (unseen)
    sentences += fmt::format(
        "Where the masses take less than {:g} of the torque, its scale is unseen.\n", kSeen);
  return table.format() + "\n" + sentences;
}

std::string weighing_table(const Weighing& w, TableFormat format) {
  const bool text = format == TableFormat::kText;
  std::vector<TableWriter::Column> columns = {
      {"seen", "", true},    {"mass", "kg"}, {"std error", "kg"},
      {"x", "kg m"},         {"y", "kg m"},  {"z", "kg m"},
      {"std error", "kg m"}, {"windows"},    {"left", "N m rms"}};
  if (!text)  // else in a sentence
    for (const char* axis : {"x", "y", "z"})
      for (const char* of : {"center ", "std error of center "})
        columns.push_back({std::string(of) + axis, "m"});
  TableWriter table(std::move(columns));
  const auto add = [&](const char* what, const Weight& s, bool measured) {
    std::vector<std::string> cells = {what,
                                      fmt::format("{:.3f}", s.mass),
                                      fmt::format("{:.2g}", s.mass_error),
                                      fmt::format("{:.4f}", s.moment[0]),
                                      fmt::format("{:.4f}", s.moment[1]),
                                      fmt::format("{:.4f}", s.moment[2]),
                                      fmt::format("{:.2g}", s.moment_error.maxCoeff()),
                                      measured ? fmt::format("{}", s.windows) : "",
                                      measured ? number(s.residual) : ""};
    for (int i = 0; i < 3 && !text; ++i) {
      const bool known = !measured && w.payload.mass > 3 * w.payload.mass_error;
      cells.push_back(known ? fmt::format("{:.4f}", w.center[i]) : "");
      cells.push_back(known ? fmt::format("{:.2g}", w.center_error[i]) : "");
    }
    table.add(std::move(cells));
  };
  add("loaded", w.loaded, true);
  if (w.empty.windows > 0) add("empty", w.empty, true);
  add("payload", w.payload, false);
  std::string out = table.format(format);
  if (!text) return out;
  out += fmt::format("\nMoments are about the origin of the body '{}', in its axes.\n",
                     printable_name(w.body));
  if (w.payload.mass > 3 * w.payload.mass_error) {
    out += fmt::format("Center of mass [m]: {:.4f} +- {:.2g}, {:.4f} +- {:.2g}, {:.4f} +- {:.2g}\n",
                       w.center[0], w.center_error[0], w.center[1], w.center_error[1], w.center[2],
                       w.center_error[2]);
  }
  if (w.empty.windows == 0)
    out +=
        "Without recordings of the empty arm (the logs before --weigh), what the model has wrong "
        "is weighed, too.\n";
  return out;
}

std::string identification_report(const std::vector<Term>& terms, const Identification& id) {
  TableWriter table({{"term", "", true},
                     {"unit", "", true},
                     {"estimate"},
                     {"std error", "if white"},
                     {"std error", "robust"},
                     {"excitation", "rms"},
                     {"own share"}});
  for (std::size_t i = 0; i < terms.size(); ++i) {
    const Parameter& p = id.parameters[i];
    table.add({terms[i].name, terms[i].unit, fmt::format("{:.5g}", p.theta),
               fmt::format("{:.2g}", p.sigma), fmt::format("{:.2g}", p.robust),
               fmt::format("{:.4g}", p.excitation), fmt::format("{:.3f}", p.own)});
  }
  std::string out = table.format();
  out += fmt::format(
      "\nresidual {:.3g} N m, condition number {:.3g}, {} windows used, {} left out (slow, or a "
      "gap)\n",
      id.residual, id.condition, id.windows, id.left_out);
  if (id.condition > 100) {
    out += "The motion hardly tells some terms apart: see the smallest own share.\n";
  }
  if (id.colour > 3) {
    out += fmt::format(
        "The residuals are no white noise (Ljung-Box, {:.0f} standard deviations): use the robust "
        "errors; if the model lacks a\nterm, theta is biased by more than they say.\n",
        id.colour);
  }
  return out + missing(id.missing, "");
}

std::string identification_csv(const std::vector<Term>& terms, const Identification& id) {
  std::string out = "term,unit,estimate,std_error,robust_std_error\n";
  for (std::size_t i = 0; i < terms.size(); ++i) {
    out += fmt::format("{},{},{:.17g},{:.17g},{:.17g}\n", terms[i].name, terms[i].unit,
                       id.parameters[i].theta, id.parameters[i].sigma, id.parameters[i].robust);
  }
  return out;
}

}  // namespace tauext
