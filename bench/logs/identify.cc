// SPDX-License-Identifier: Apache-2.0
#include "bench/logs/identify.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Cholesky>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "estimators/types.h"
#include "mjcf/trace/known.h"

namespace tauext {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kLongestGap = 0.05;  // [s]
constexpr double kLeast = 1e-100;     // in the place of a norm or a singular value of 0

double sign(double x) {
  return x > 0 ? 1 : x < 0 ? -1 : 0;
}

// whether (i) can be taken over samples a to b: moving one way all the time, and no gap
bool usable(const Trace& log, int a, int b, double min_speed) {
  for (int k = a; k <= b; ++k) {
    const double qd = log.qd(0, k);
    if (std::abs(qd) < min_speed || sign(qd) != sign(log.qd(0, a))) return false;
    if (k > a && log.t[k] - log.t[k - 1] > kLongestGap) return false;
  }
  return true;
}

// (i) over samples a to b: the row of the regressor, and mean(tau) behind it
VectorXd row(const Trace& log, int a, int b, const std::vector<Term>& terms) {
  const double T = log.t[b] - log.t[a];
  const auto n = static_cast<Eigen::Index>(terms.size());
  VectorXd r = VectorXd::Zero(n + 1);
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto& f = terms[i].column;
    if (!f) {
      r[i] = (log.qd(0, b) - log.qd(0, a)) / T;
      continue;
    }
    for (int k = a; k < b; ++k) {
      const double h = log.t[k + 1] - log.t[k];
      r[i] += h / T * 0.5 * (f(log.q(0, k), log.qd(0, k)) + f(log.q(0, k + 1), log.qd(0, k + 1)));
    }
  }
  for (int k = a; k < b; ++k) {
    const double end = log.torque_at_instants ? log.tau(0, k + 1) : log.tau(0, k);
    r[n] += (log.t[k + 1] - log.t[k]) / T * 0.5 * (log.tau(0, k) + end);
  }
  return r;
}

void check(const Trace& log, const std::vector<Term>& terms, const Windows& w) {
  if (log.dof() != 1) {
    throw std::invalid_argument(
        fmt::format("a one-joint model is identified; the log has {} joints", log.dof()));
  }
  if (terms.empty()) throw std::invalid_argument("no term to identify");
  if (!(w.length > 0 && w.length <= 10) || !(w.min_speed >= 0 && std::isfinite(w.min_speed))) {
    throw std::invalid_argument(fmt::format(
        "window of {} s, min_speed {} rad/s: 0 to 10 s, and not negative", w.length, w.min_speed));
  }
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

using Window = std::pair<int, int>;  // samples, from the first to the one where the next begins

std::vector<Window> windows_of(const Trace& log, const Windows& w, int& left_out) {
  std::vector<Window> all;
  for (int a = 0; a + 1 < log.size();) {
    int b = a + 1;
    while (b + 1 < log.size() && log.t[b] - log.t[a] < w.length * (1 - 1e-9)) ++b;
    if (log.t[b] - log.t[a] < w.length * (1 - 1e-9)) break;  // the rest is no whole window
    if (usable(log, a, b, w.min_speed)) {
      all.emplace_back(a, b);
    } else {
      ++left_out;
    }
    a = b;
  }
  return all;
}

// what the residuals say; a loadcell that is not linear adds powers of tau
void add_residuals(const Trace& log, const std::vector<Term>& model,
                   const std::vector<Window>& windows, const MatrixXd& A, const VectorXd& residuals,
                   Identification& id) {
  const std::vector<Term> rest = others(model);
  const auto n = static_cast<Eigen::Index>(rest.size());
  MatrixXd columns(A.rows(), n + 2);
  for (Eigen::Index i = 0; i < A.rows(); ++i) {
    const auto [a, b] = windows[static_cast<std::size_t>(i)];
    const VectorXd r = row(log, a, b, rest);
    columns.row(i) << r.head(n).transpose(), r[n] * r[n], r[n] * r[n] * r[n];
  }
  std::vector<std::string> names;
  for (const Term& t : rest) names.push_back(t.name);
  names.insert(names.end(),
               {"a loadcell that is not linear (tau^2)", "a loadcell that is not linear (tau^3)"});
  const MatrixXd one = MatrixXd::Identity(A.cols(), A.cols());
  const MatrixXd inverse = (A.transpose() * A).ldlt().solve(one);
  const VectorXd robust = robust_errors(A, inverse, residuals);
  for (std::size_t i = 0; i < id.parameters.size(); ++i) {
    id.parameters[i].robust = robust[static_cast<Eigen::Index>(i)];
  }
  if (id.residual <= 1e-6 * id.torque) return;  // no sensor's noise, but the integration's error
  id.colour = colour(residuals);
  id.missing = suspects(A, inverse, residuals, columns, names);
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
  const std::vector<Window> windows = windows_of(log, w, id.left_out);
  id.windows = static_cast<int>(windows.size());
  const auto n = static_cast<Eigen::Index>(terms.size()),
             m = static_cast<Eigen::Index>(windows.size());
  if (m < 3 * n) {
    throw std::invalid_argument(fmt::format(
        "{} usable windows of {} s for {} parameters, at least {} are needed; {} were left out as "
        "slower than {} rad/s or across a gap, in a log of {:.3g} s",
        m, w.length, n, 3 * n, id.left_out, w.min_speed, log.t.back() - log.t.front()));
  }

  MatrixXd A(m, n);
  VectorXd y(m);
  for (Eigen::Index i = 0; i < m; ++i) {
    const auto [a, b] = windows[static_cast<std::size_t>(i)];
    const VectorXd r = row(log, a, b, terms);
    A.row(i) = r.head(n);
    y[i] = r[n];
  }
  const VectorXd norm = A.colwise().norm();
  const MatrixXd scaled = A * norm.cwiseMax(kLeast).cwiseInverse().asDiagonal();
  const Eigen::JacobiSVD<MatrixXd> svd(scaled, Eigen::ComputeThinU | Eigen::ComputeThinV);
  const VectorXd& s = svd.singularValues();
  // The norm of row i of V S^-1 is the root of the i-th diagonal element of (A^T A)^-1, A with its
  // columns scaled; its inverse is the share of column i that the others cannot imitate.
  const VectorXd root =
      (svd.matrixV() * s.cwiseMax(kLeast).cwiseInverse().asDiagonal()).rowwise().norm();
  id.condition = s[0] / s[n - 1];
  if (!(id.condition < 1e6)) {
    Eigen::Index least = 0;
    root.maxCoeff(&least);
    throw std::invalid_argument(fmt::format(
        "the motion cannot tell '{}' from the other terms (condition {:.1e}): record one "
        "that excites it, or leave it out",
        terms[least].name, id.condition));
  }
  const VectorXd theta = norm.cwiseInverse().asDiagonal() * svd.solve(y);
  const VectorXd residuals = y - A * theta;
  id.torque = std::sqrt(y.squaredNorm() / static_cast<double>(m));
  id.residual = std::sqrt(residuals.squaredNorm() / static_cast<double>(m - n));
  for (Eigen::Index i = 0; i < n; ++i) {
    id.parameters.push_back({theta[i], id.residual * root[i] / norm[i], 0,
                             norm[i] / std::sqrt(static_cast<double>(m)),
                             std::min(1 / root[i], 1.)});
  }
  add_residuals(log, terms, windows, A, residuals, id);
  return id;
}

}  // namespace tauext
