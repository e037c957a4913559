// SPDX-License-Identifier: Apache-2.0
#include "bench/calibrate/identify.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "bench/calibrate/windows.h"
#include "estimators/types.h"
#include "mjcf/trace/known.h"

namespace tauext {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

double sign(double x) {
  return x > 0 ? 1 : x < 0 ? -1 : 0;
}

// (i) over a window: the row of the regressor, and mean(tau) behind it
VectorXd row(const Trace& log, const Window& w, const std::vector<Term>& terms) {
  const auto n = static_cast<Eigen::Index>(terms.size());
  VectorXd r(n + 1);
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto& f = terms[i].column;
    r[i] = f ? mean_over(log, w, [&](int k) { return f(log.q(0, k), log.qd(0, k)); })
             : mean_change(log, w, [&](int k) { return log.qd(0, k); });
  }
  r[n] = mean_torque(log, 0, w);
  return r;
}

void check(const Trace& log, const std::vector<Term>& terms, const Windows& w) {
  if (log.dof() != 1) {
    throw std::invalid_argument(
        fmt::format("a one-joint model is identified, and the log has {} joints: --robot FILE "
                    "calibrates an arm",
                    log.dof()));
  }
  if (terms.empty()) throw std::invalid_argument("no term to identify");
  check_windows(w);
}

std::vector<std::string> names_of(const std::vector<Term>& all) {
  std::vector<std::string> names;
  for (const Term& t : all) names.push_back(t.name);
  return names;
}

// what may be missing from the model: the terms that it has not
std::vector<Term> others(const std::vector<Term>& model) {
  std::vector<Term> rest;
  for (const Term& t : terms()) {
    const auto same = [&](const Term& m) { return m.name == t.name; };
    if (t.column && std::none_of(model.begin(), model.end(), same)) rest.push_back(t);
  }
  return rest;
}

// what the residuals say; a loadcell that is not linear adds powers of tau
void add_residuals(const Trace& log, const std::vector<Term>& model,
                   const std::vector<Window>& windows, const Fit& f, Identification& id) {
  if (id.residual <= 1e-6 * id.torque) return;  // no sensor's noise, but the integration's error
  const std::vector<Term> rest = others(model);
  const auto n = static_cast<Eigen::Index>(rest.size());
  MatrixXd columns(f.residuals.size(), n + 2);
  for (Eigen::Index i = 0; i < columns.rows(); ++i) {
    const VectorXd r = row(log, windows[static_cast<std::size_t>(i)], rest);
    columns.row(i) << r.head(n).transpose(), r[n] * r[n], r[n] * r[n] * r[n];
  }
  std::vector<std::string> names = names_of(rest);
  names.insert(names.end(),
               {"a loadcell that is not linear (tau^2)", "a loadcell that is not linear (tau^3)"});
  id.colour = colour(f.residuals);
  id.missing = suspects(f.shown, f.inverse, f.residuals, columns, names);
}

}  // namespace

const std::vector<Term>& terms() {
  static const std::vector<Term> all = {
      {"inertia", "kg m^2", "qdd", nullptr},
      {"gravity_cos", "kg m", "g cos q", [](double q, double) { return kGravity * std::cos(q); }},
      {"gravity_sin", "kg m", "g sin q", [](double q, double) { return kGravity * std::sin(q); }},
      {"coulomb", "N m", "sign(qd)", [](double, double qd) { return sign(qd); }},
      {"viscous", "N m s/rad", "qd", [](double, double qd) { return qd; }},
      {"quadratic", "N m s^2/rad^2", "qd |qd|",
       [](double, double qd) { return qd * std::abs(qd); }},
      {"stribeck", "N m", "sign(qd) exp(-|qd| / 0.1 rad/s)",
       [](double, double qd) { return sign(qd) * std::exp(-std::abs(qd) / 0.1); }},
      {"coulomb_up", "N m", "1 where qd > 0", [](double, double qd) { return qd > 0 ? 1. : 0.; }},
      {"coulomb_down", "N m", "-1 where qd < 0",
       [](double, double qd) { return qd < 0 ? -1. : 0.; }},
      {"spring", "N m/rad", "q", [](double q, double) { return q; }},
      {"offset", "N m", "1", [](double, double) { return 1.; }},
  };
  return all;
}

std::vector<Term> find_terms(const std::vector<std::string>& names) {
  refuse_twice("term", names);
  std::vector<Term> found;
  for (const std::string& name : names) {
    found.push_back(find_known(terms(), "term", name, [](const Term& t) { return t.name; }));
  }
  return found;
}

Identification identify(const Trace& log, const std::vector<Term>& terms, const Windows& w) {
  check(log, terms, w);
  Identification id;
  const std::vector<Window> windows = windows_of(log, 0, w, id.left_out);
  id.windows = static_cast<int>(windows.size());
  const auto n = static_cast<Eigen::Index>(terms.size()),
             m = static_cast<Eigen::Index>(windows.size());
  if (m < 3 * n) {
    throw std::invalid_argument(fmt::format(
        "{}, in a log of {:.3g} s", too_few(windows.size(), 3 * terms.size(), id.left_out, w),
        log.t.back() - log.t.front()));
  }

  MatrixXd A(m, n);
  VectorXd y(m);
  for (Eigen::Index i = 0; i < m; ++i) {
    const VectorXd r = row(log, windows[static_cast<std::size_t>(i)], terms);
    A.row(i) = r.head(n);
    y[i] = r[n];
  }
  MatrixXd Z = A;
  for (Eigen::Index k = 0; k < n; ++k)
    for (Eigen::Index i = 0; i < m && !terms[static_cast<std::size_t>(k)].column; ++i)
      Z(i, k) = change_around(log, windows[static_cast<std::size_t>(i)],
                              [&](int sample) { return log.qd(0, sample); });
  const Fit f = fit(A, Z, y, names_of(terms));
  id.parameters = f.parameters;
  id.condition = f.condition;
  id.torque = f.y;
  id.residual = f.residual;
  add_residuals(log, terms, windows, f, id);
  for (std::size_t i = 0; i < terms.size(); ++i) {
    const Parameter& p = f.parameters[i];
    if ((terms[i].name == "inertia" || terms[i].name == "coulomb") &&
        p.theta < -kSurely * p.robust && p.theta * p.excitation < -kMatters * f.y)
      id.doubts.push_back(fmt::format(
          "{} is {:.3g} +- {:.2g} {}, and no joint has less than none: is the sign of its torque "
          "right, which `sign` in the map of columns turns, and are its units?",
          terms[i].name, p.theta, p.robust, terms[i].unit));
  }
  return id;
}

}  // namespace tauext
