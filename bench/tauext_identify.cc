// SPDX-License-Identifier: Apache-2.0
// tauext-identify: the parameters of a one-joint model from a recorded motion.
#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "bench/logs/identify.h"
#include "bench/logs/read_log.h"
#include "bench/program/program.h"
#include "mjcf/trace/atomic_file.h"
#include "mjcf/trace/table_writer.h"

namespace {

using namespace tauext;

std::string list_terms() {
  TableWriter table({{"term", "", true}, {"unit", "", true}, {"what it multiplies", "", true}});
  for (const Term& t : terms()) table.add({t.name, t.unit, t.description});
  return table.format();
}

std::string as_table(const std::vector<Term>& terms, const Identification& id) {
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
  for (const Suspect& s : id.missing) {
    out += fmt::format(
        "Missing? {} would explain {:.0f} % of the residuals' variance ({:.0f} "
        "standard errors).\n",
        s.name, 100 * s.share, s.surely);
  }
  return out;
}

std::string as_csv(const std::vector<Term>& terms, const Identification& id) {
  std::string out = "term,unit,estimate,std_error,robust_std_error\n";
  for (std::size_t i = 0; i < terms.size(); ++i) {
    out += fmt::format("{},{},{:.17g},{:.17g},{:.17g}\n", terms[i].name, terms[i].unit,
                       id.parameters[i].theta, id.parameters[i].sigma, id.parameters[i].robust);
  }
  return out;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "Identifies a one-joint model, linear in its parameters, from a log of a motion without\n"
      "contact (t,q1,qd1,tau1 in s, rad, rad/s, N m), by linear least squares: by default\n"
      "tau = theta1 qdd + theta2 g cos q + theta3 g sin q + theta4 sign(qd).\n\n"
      "  tauext-identify log.csv\n",
      "tauext-identify");
  std::string log, channel, columns, out;
  std::vector<std::string> names = {"inertia", "gravity_cos", "gravity_sin", "coulomb"};
  Windows windows;
  bool list = false;
  app.add_option("log", log, "log to read: CSV, .npy, .npz, .db3 or LCM");
  app.add_option("--channel", channel, "of an LCM log, or topic of a bag, with several of them");
  app.add_option("--columns", columns, "what the log's columns mean (see tauext-replay --help)")
      ->type_name("PRESET|FILE.toml");
  app.add_option("--terms", names, "terms of the model, separated by commas (see --list)")
      ->delimiter(',')
      ->allow_extra_args(false);
  app.add_option("--window", windows.length, "length of a difference and of the means [s]")
      ->capture_default_str();
  app.add_option("--min_speed", windows.min_speed,
                 "slower samples are left out: friction there is unknown [rad/s]")
      ->capture_default_str();
  app.add_option("--out", out, "CSV to write, too; - is standard output");
  app.add_flag("--list", list, "list the terms, and stop");
  return run_program(app, argc, argv, [&] {
    if (list) {
      fmt::print("{}", list_terms());
      return kGood;
    }
    if (log.empty()) throw std::invalid_argument("a log is required; see tauext-identify --help");
    const std::vector<Term> model = find_terms(names);
    const RecordedLog recorded = read_any_log(log, {channel, columns});
    const Identification id = identify(recorded.trace, model, windows);
    if (!out.empty()) {
      AtomicFile file(out);
      file.write(as_csv(model, id));
      file.commit();
    }
    fmt::print(out == "-" ? stderr : stdout, "{}", as_table(model, id));
    return recorded.usable() ? kGood : kAnswerIsNo;
  });
}
