// SPDX-License-Identifier: Apache-2.0
#include "bench/report/traces.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <queue>
#include <string_view>
#include <utility>

#include "bench/report/provenance.h"
#include "bench/roster/baselines.h"

namespace tauext::report {
namespace {

using Json = nlohmann::ordered_json;

struct Bucket {
  int from, to;
  double change;  // of the signal that changes most, as a share of its range or floor
  bool operator<(const Bucket& other) const { return change < other.change; }
};

Eigen::VectorXd finite(const Eigen::VectorXd& signal) {
  return signal.unaryExpr([](double x) { return std::isfinite(x) ? x : 0.; });
}

// base64 of 16-bit numbers, the low byte first
std::string base64(const std::vector<std::uint16_t>& values) {
  constexpr std::string_view kDigits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  std::uint32_t bits = 0;
  int held = 0;
  for (std::size_t i = 0; i < 2 * values.size(); ++i) {
    bits = (bits << 8) | ((values[i / 2] >> (i % 2 ? 8 : 0)) & 0xff);
    for (held += 8; held >= 6; held -= 6) out += kDigits[(bits >> (held - 6)) & 0x3f];
  }
  if (held > 0) out += kDigits[(bits << (6 - held)) & 0x3f];
  while (out.size() % 4 != 0) out += '=';
  return out;
}

// times from and to which a contact acts
Json spans(const std::vector<std::uint8_t>& contact, const std::vector<double>& t) {
  Json all = Json::array();
  for (std::size_t k = 0; k < contact.size(); ++k) {
    if (contact[k] == 0) continue;
    const std::size_t begin = k;
    while (k + 1 < contact.size() && contact[k + 1] != 0) ++k;
    all.push_back({t[begin], t[k]});
  }
  return all;
}

// a row for each component of the force that these torques mean, and of the moment
Eigen::MatrixXd wrench_of(const Trace& trace, const Eigen::MatrixXd& tau_ext,
                          const ArmForces* forces) {
  if (forces == nullptr) return {};
  const bool moment = trace.dof() >= kJointsOfMoment;
  Eigen::MatrixXd wrench(moment ? 6 : 3, trace.size());
  for (int k = 0; k < trace.size(); ++k) {
    const SiteForce f = forces->at_site(trace.q.col(k).data(), tau_ext.col(k).data());
    wrench.col(k).head<3>() = f.force;
    if (moment) wrench.col(k).tail<3>() = f.moment;
  }
  return wrench;
}

Json drawn_rows(const Eigen::MatrixXd& signals, const std::vector<int>& edges) {
  Json rows = Json::array();
  for (const auto& signal : signals.rowwise()) {
    const Drawn d = draw(signal.transpose(), edges);
    rows.push_back({{"low", d.low}, {"high", d.high}, {"values", base64(d.values)}});
  }
  return rows;
}

}  // namespace

std::vector<int> bucket_edges(const std::vector<Signals>& of_units, int buckets) {
  constexpr double kFloor = 1e-3;  // of the unit's largest range: less is rest, like rounding noise
  std::vector<std::pair<const Eigen::VectorXd*, double>> ranges;
  for (const Signals& signals : of_units) {
    const std::size_t begin = ranges.size();
    double largest = 0;
    for (const Eigen::VectorXd& s : signals) {
      ranges.emplace_back(&s, s.maxCoeff() - s.minCoeff());
      largest = std::max(largest, ranges.back().second);
    }
    for (std::size_t i = begin; i < ranges.size(); ++i)
      ranges[i].second = std::max(ranges[i].second, kFloor * largest);
  }
  const int n = static_cast<int>(ranges.at(0).first->size());
  const auto bucket = [&](int from, int to) {
    double most = 0;
    for (const auto& [s, range] : ranges) {
      const auto part = s->segment(from, to - from);
      if (range > 0) most = std::max(most, (part.maxCoeff() - part.minCoeff()) / range);
    }
    // of two that change alike, and where nothing does, the longer one
    return Bucket{from, to, to - from > 1 ? most + 1e-3 * (to - from) / n : -1};
  };
  std::priority_queue<Bucket> all;
  all.push(bucket(0, n));
  while (static_cast<int>(all.size()) < buckets && all.top().change >= 0) {
    const Bucket b = all.top();
    all.pop();
    const int middle = (b.from + b.to) / 2;
    all.push(bucket(b.from, middle));
    all.push(bucket(middle, b.to));
  }
  std::vector<int> edges = {n};
  for (; !all.empty(); all.pop()) edges.push_back(all.top().from);
  std::sort(edges.begin(), edges.end());
  return edges;
}

Drawn draw(const Eigen::VectorXd& signal, const std::vector<int>& edges) {
  const Eigen::VectorXd s = finite(signal);
  Drawn d{s.minCoeff(), s.maxCoeff(), {}};
  const double range = d.high > d.low ? d.high - d.low : 1;
  for (std::size_t i = 0; i + 1 < edges.size(); ++i) {
    const auto part = s.segment(edges[i], edges[i + 1] - edges[i]);
    Eigen::Index least = 0, most = 0;
    part.minCoeff(&least), part.maxCoeff(&most);
    for (const Eigen::Index k : {std::min(least, most), std::max(least, most)})
      d.values.push_back(
          static_cast<std::uint16_t>(std::lround(65535 * (part[k] - d.low) / range)));
  }
  return d;
}

void Traces::add(const Entry& entry, const Suite::Run& run, const ArmForces* forces) {
  const auto series = [&](const std::string& name, const Eigen::MatrixXd& tau_ext) {
    series_.push_back({name, tau_ext, wrench_of(run.trace, tau_ext, forces)});
  };
  if (entry.group() != group_) close();
  group_ = entry.group();
  if (series_.empty()) {
    t_ = run.trace.t;
    contact_ = run.trace.contact;
    series("truth", run.trace.tau_ext);
  }
  if (!entry.detector().empty()) {
    marks_.push_back({entry.estimator() + "+" + entry.detector(), {}});
    for (std::size_t k = 0; k < run.detections.size(); ++k) {
      if (run.detections[k].mark) marks_.back().t.push_back(run.trace.t[k]);
    }
  } else if (!is_baseline(entry.estimator())) {
    series(entry.estimator(), run.output.tau_ext);
  }
}

void Traces::close() {
  if (series_.empty()) return;
  Signals torques, forces;  // [N m], [N]
  for (const Series& s : series_) {
    for (const auto& row : s.tau_ext.rowwise()) torques.push_back(finite(row.transpose()));
    for (Eigen::Index i = 0; i < s.wrench.rows(); ++i)
      (i < 3 ? forces : torques).push_back(finite(s.wrench.row(i).transpose()));
  }
  const std::vector<int> edges = bucket_edges({torques, forces});
  Json j = {{"name", group_}, {"t", Json::array()}};
  if (!site_.empty()) j["site"] = site_;
  // a bucket's first and last sample, at which its extremes are drawn
  for (std::size_t i = 0; i + 1 < edges.size(); ++i) {
    j["t"].push_back(t_[static_cast<std::size_t>(edges[i])]);
    j["t"].push_back(t_[static_cast<std::size_t>(edges[i + 1]) - 1]);
  }
  j["contacts"] = spans(contact_, t_);
  j["series"] = Json::array();
  for (const Series& s : series_) {
    j["series"].push_back({{"name", s.name}, {"joints", drawn_rows(s.tau_ext, edges)}});
    if (s.wrench.size() > 0) j["series"].back()["wrench"] = drawn_rows(s.wrench, edges);
  }
  j["marks"] = Json::array();
  for (const Marks& m : marks_) j["marks"].push_back({{"name", m.name}, {"t", m.t}});
  groups_ += (groups_.empty() ? "" : ",\n") + j.dump();
  series_.clear(), marks_.clear();
}

std::string Traces::json(const std::string& run) {
  close();
  Json context;
  for (const auto& [key, text] : provenance(run)) context[key] = text;
  return fmt::format("{{\"format\":\"tauext-traces-1\",\"context\":{},\"groups\":[{}]}}\n",
                     context.dump(), groups_);
}

}  // namespace tauext::report
