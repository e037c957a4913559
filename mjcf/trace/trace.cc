// SPDX-License-Identifier: Apache-2.0
#include "mjcf/trace/trace.h"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstring>
#include <fstream>
#include <limits>
#include <map>
#include <stdexcept>
#include <string_view>

#include "mjcf/trace/atomic_file.h"
#include "mjcf/trace/input_file.h"
#include "mjcf/trace/timed_rows.h"

namespace tauext {
namespace {

constexpr const char* kVectors[] = {"q", "qd", "tau", "tau_ext"};
constexpr const char* kAtInstants = "tau_instant";  // instead of tau

std::vector<std::string_view> split(std::string_view line) {
  if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
  std::vector<std::string_view> fields;
  for (;;) {
    const auto comma = line.find(',');
    std::string_view f = line.substr(0, comma);
    while (!f.empty() && f.front() == ' ') f.remove_prefix(1);
    while (!f.empty() && f.back() == ' ') f.remove_suffix(1);
    fields.push_back(f);
    if (comma == std::string_view::npos) return fields;
    line.remove_prefix(comma + 1);
  }
}

// where each quantity stands in a row
struct Columns {
  int count = 0, dof = 0, t = -1, contact = -1;
  bool torque_at_instants = false;
  std::map<std::string, std::vector<int>> of;  // by kVectors
};

Columns parse_header(std::string_view line, const std::string& path) {
  std::map<std::string, int, std::less<>> at;
  const auto names = split(line);
  double number = 0;
  const char* const end = names[0].data() + names[0].size();
  if (std::from_chars(names[0].data(), end, number).ptr == end && !names[0].empty()) {
    throw std::runtime_error(fmt::format(
        "{}: begins with numbers: the first line must name the columns, like t,q1,qd1,tau1", path));
  }
  for (int i = 0; i < static_cast<int>(names.size()); ++i) {
    if (!at.emplace(names[i], i).second) {
      throw std::runtime_error(fmt::format("{}: column '{}' appears twice", path, names[i]));
    }
  }
  const auto find = [&](const std::string& name) {
    const auto it = at.find(name);
    return it == at.end() ? -1 : it->second;
  };
  Columns c;
  c.count = static_cast<int>(names.size());
  c.t = find("t");
  c.contact = find("contact");
  while (find(fmt::format("q{}", c.dof + 1)) >= 0) ++c.dof;
  c.torque_at_instants = find(fmt::format("{}1", kAtInstants)) >= 0;
  if (c.torque_at_instants && find("tau1") >= 0) {
    throw std::runtime_error(
        fmt::format("{}: has tau1, which holds, and {}1: rename one of them", path, kAtInstants));
  }
  for (const std::string name : kVectors) {
    const bool instants = name == "tau" && c.torque_at_instants;
    for (int j = 1; j <= c.dof; ++j) {
      const std::string column = fmt::format("{}{}", instants ? kAtInstants : name, j);
      c.of[name].push_back(find(column));
      if (c.of[name].back() >= 0 || name == "tau_ext") continue;
      throw std::runtime_error(fmt::format("{}: has q{} but no column '{}'", path, j, column));
    }
  }
  const std::vector<int>& truth = c.of["tau_ext"];
  const auto missing = std::count(truth.begin(), truth.end(), -1);
  if (missing != 0 && missing != c.dof) {
    throw std::runtime_error(fmt::format("{}: has some of tau_ext1..{} but not all", path, c.dof));
  }
  if (c.t < 0 || c.dof == 0) {
    std::string start(line.substr(0, 60));
    std::replace_if(
        start.begin(), start.end(), [](char x) { return x < ' ' || x > '~'; }, '?');
    throw std::runtime_error(
        fmt::format("{}: the first line must name the columns "
                    "t,q1..,qd1..,tau1..[,tau_ext1..][,contact]; it is '{}'",
                    path, start));
  }
  return c;
}

// the row's numbers, or why it cannot be used
const char* parse_row(std::string_view line, const Columns& c, std::vector<double>& values,
                      SkippedRows& skipped) {
  const auto fields = split(line);
  if (static_cast<int>(fields.size()) != c.count) {
    ++skipped.wrong_field_count;
    return "wrong number of fields";
  }
  values.resize(fields.size());
  for (std::size_t i = 0; i < fields.size(); ++i) {
    const auto [end, error] =
        std::from_chars(fields[i].data(), fields[i].data() + fields[i].size(), values[i]);
    if (error == std::errc::result_out_of_range) {
      values[i] = std::numeric_limits<double>::infinity();
    } else if (error != std::errc() || end != fields[i].data() + fields[i].size()) {
      ++skipped.not_a_number;
      return "a field is not a number";
    }
    if (!std::isfinite(values[i])) {
      ++skipped.not_finite;
      return "a field is not finite";
    }
  }
  return nullptr;
}

Eigen::MatrixXd gather(const std::vector<std::vector<double>>& rows,
                       const std::vector<int>& columns) {
  for (const int c : columns) {
    if (c < 0) return {};
  }
  Eigen::MatrixXd m(columns.size(), rows.size());
  for (std::size_t k = 0; k < rows.size(); ++k) {
    for (std::size_t j = 0; j < columns.size(); ++j) m(j, k) = rows[k][columns[j]];
  }
  return m;
}

// lines up to a length; a file without line ends is not taken whole
class Lines {
 public:
  Lines(std::istream& in, const std::string& path) : in_(in), path_(path), buffer_(kLongest + 1) {}

  // false at the end
  bool next(std::string& line) {
    ++number_;
    in_.getline(buffer_.data(), static_cast<std::streamsize>(buffer_.size()));
    const auto size = static_cast<std::size_t>(in_.gcount());
    if (in_.fail() && size == kLongest) {
      throw std::runtime_error(fmt::format("{}: line {} is longer than {} bytes: no CSV of ours",
                                           path_, number_, kLongest));
    }
    // the line end was taken, and is counted, unless the file ended
    line.assign(buffer_.data(), size - (in_.good() ? 1 : 0));
    return !in_.fail();
  }
  int number() const { return number_; }

 private:
  static constexpr std::size_t kLongest = (1 << 16) - 1;  // [bytes] of a thousand numbers
  std::istream& in_;
  const std::string& path_;
  std::vector<char> buffer_;
  int number_ = 0;
};

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
  for (auto* m : {&s.q, &s.qd, &s.tau, &s.tau_ext, &s.tau_ext_of_driver, &s.qdd, &s.friction}) {
    if (m->cols() > 0) *m = Eigen::MatrixXd((*m)(Eigen::all, samples));
  }
  if (s.force.cols() > 0) s.force = Eigen::Matrix3Xd(trace.force(Eigen::all, samples));
  const auto stop = std::lower_bound(samples.begin(), samples.end(), trace.stopped_at);
  if (trace.stopped_at >= 0) s.stopped_at = static_cast<int>(stop - samples.begin());
  return s;
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

Trace read_csv(const std::string& path, SkippedRows* skipped) {
  claim_input(path);
  errno = 0;
  std::ifstream in(path);
  Lines lines(in, path);
  std::string line;
  if (!in || !lines.next(line)) {
    const int reason = errno;
    throw std::runtime_error(
        fmt::format("{}: {}", path, reason == 0 ? "is empty" : std::strerror(reason)));
  }
  if (line.starts_with("\xEF\xBB\xBF")) line.erase(0, 3);  // a byte order mark, as Excel writes
  const Columns c = parse_header(line, path);
  TimedRows timed(c.t, *skipped);
  std::vector<double> values;
  while (lines.next(line)) {
    if (line.empty() || line == "\r") continue;
    const char* reason = parse_row(line, c, values, *skipped);
    if (reason == nullptr && in.eof()) {  // no line end: the last number may be cut
      ++skipped->wrong_field_count;
      reason = "the last line is incomplete";
    }
    if (reason != nullptr) {
      skipped->say(lines.number(), reason);
      continue;
    }
    timed.take(values, lines.number());
  }
  const std::vector<std::vector<double>> rows = timed.finish();
  if (in.bad()) throw std::runtime_error(fmt::format("{}: {}", path, std::strerror(errno)));
  if (rows.empty()) {
    throw std::runtime_error(fmt::format("{}: no usable row ({} skipped{}{})", path,
                                         skipped->total(), skipped->first.empty() ? "" : "; ",
                                         skipped->first.empty() ? "" : skipped->first[0]));
  }
  Trace trace;
  for (const auto& r : rows) {
    trace.t.push_back(r[c.t]);
    if (c.contact >= 0) trace.contact.push_back(r[c.contact] != 0);
  }
  trace.q = gather(rows, c.of.at("q"));
  trace.qd = gather(rows, c.of.at("qd"));
  trace.tau = gather(rows, c.of.at("tau"));
  trace.tau_ext = gather(rows, c.of.at("tau_ext"));
  trace.torque_at_instants = c.torque_at_instants;
  return trace;
}

}  // namespace tauext
