// SPDX-License-Identifier: Apache-2.0
#include "bench/replay/estimates_writer.h"

#include <fmt/format.h>

#include <cstddef>
#include <initializer_list>
#include <iterator>
#include <utility>

#include "mjcf/trace/atomic_file.h"
#include "mjcf/trace/read/npy_writer.h"

namespace tauext {
namespace {

// with one estimator, <detector>_mark is unambiguous; with more, the estimator's name comes first
std::string marks_name(const Replayed& c, bool several) {
  return several ? fmt::format("{}_{}_mark", c.estimator(), c.detector())
                 : fmt::format("{}_mark", c.detector());
}

std::string titles_of_forces(const std::string& estimator, int dof) {
  const bool moment = dof >= kJointsOfMoment;
  std::string all;
  const auto add = [&](std::initializer_list<const char*> names) {
    for (const char* n : names) all += fmt::format(",{}_{}", estimator, n);
  };
  add({"fx", "fy", "fz"});
  if (moment) add({"mx", "my", "mz"});
  add({"seen_fx", "seen_fy", "seen_fz"});
  if (moment) add({"seen_mx", "seen_my", "seen_mz"});
  add({"left_over", "link"});
  if (moment) add({"line_x", "line_y", "line_z", "line_dx", "line_dy", "line_dz"});
  return all;
}

void append_forces(const Acting& a, int dof, fmt::memory_buffer& out) {
  const auto to = std::back_inserter(out);
  const int components = dof >= kJointsOfMoment ? 6 : 3;
  const auto add = [&](const auto& v, int from, int n) {
    for (int i = from; i < from + n; ++i) fmt::format_to(to, ",{:.9g}", v[i]);
  };
  add(a.force.force, 0, 3);
  if (components == 6) add(a.force.moment, 0, 3);
  add(a.force.seen, 0, components);
  fmt::format_to(to, ",{:.9g},{}", a.force.left_over, a.touch.link + 1);
  if (components == 3) return;
  if (!a.touch.has_line) {
    fmt::format_to(to, ",,,,,,");
    return;
  }
  add(a.touch.line.point, 0, 3);
  add(a.touch.line.direction, 0, 3);
}

class CsvWriter final : public EstimatesWriter {
 public:
  CsvWriter(const std::string& path, const std::vector<Replayed>& all, int dof)
      : dof_(dof), file_(path) {
    const auto to = std::back_inserter(out_);
    fmt::format_to(to, "t");
    for (const Replayed& c : all) {
      for (int j = 1; j <= dof; ++j) fmt::format_to(to, ",{}_tau_ext{}", c.estimator(), j);
      fmt::format_to(to, ",{}_status", c.estimator());
      if (!c.detector().empty()) fmt::format_to(to, ",{}", marks_name(c, all.size() > 1));
      if (c.finds_forces()) fmt::format_to(to, "{}", titles_of_forces(c.estimator(), dof));
    }
    out_.push_back('\n');
  }

  void add(double t, const std::vector<Replayed>& all) override {
    const auto to = std::back_inserter(out_);
    fmt::format_to(to, "{}", t);
    for (const Replayed& c : all) {
      for (const double d : c.tau_ext()) fmt::format_to(to, ",{}", d);
      fmt::format_to(to, ",{}", static_cast<int>(c.last().status));
      if (!c.detector().empty()) fmt::format_to(to, ",{}", int{c.last().detection.mark});
      if (c.finds_forces()) append_forces(c.acting(), dof_, out_);
    }
    out_.push_back('\n');
    if (out_.size() > kChunk) flush();
  }

  void commit() override {
    flush();
    file_.commit();
  }

 private:
  static constexpr std::size_t kChunk = 1 << 16;  // [bytes]

  void flush() {
    file_.write({out_.data(), out_.size()});
    out_.clear();
  }

  int dof_;
  AtomicFile file_;
  fmt::memory_buffer out_;
};

// arrays of NumPy, a row for each sample
class NpzWriter final : public EstimatesWriter {
 public:
  NpzWriter(std::string path, const std::vector<Replayed>& all, int dof)
      : path_(std::move(path)), moment_(dof >= kJointsOfMoment) {
    const auto joints = static_cast<std::size_t>(dof);
    arrays_.push_back({"t", 0, {}});
    for (const Replayed& c : all) {
      arrays_.push_back({c.estimator() + "_tau_ext", joints, {}});
      arrays_.push_back({c.estimator() + "_status", 0, {}});
      if (!c.detector().empty()) arrays_.push_back({marks_name(c, all.size() > 1), 0, {}});
      if (!c.finds_forces()) continue;
      arrays_.push_back({c.estimator() + "_force", 3, {}});
      if (moment_) arrays_.push_back({c.estimator() + "_moment", 3, {}});
      arrays_.push_back({c.estimator() + "_link", 0, {}});
    }
  }

  void add(double t, const std::vector<Replayed>& all) override {
    std::size_t next = 0;
    const auto put = [&](std::initializer_list<double> row) {
      std::vector<double>& to = arrays_[next++].values;
      to.insert(to.end(), row);
    };
    put({t});
    for (const Replayed& c : all) {
      std::vector<double>& to = arrays_[next++].values;
      to.insert(to.end(), c.tau_ext().begin(), c.tau_ext().end());
      put({static_cast<double>(c.last().status)});
      if (!c.detector().empty()) put({static_cast<double>(c.last().detection.mark)});
      if (!c.finds_forces()) continue;
      const SiteForce& f = c.acting().force;
      put({f.force[0], f.force[1], f.force[2]});
      if (moment_) put({f.moment[0], f.moment[1], f.moment[2]});
      put({c.acting().touch.link + 1.});
    }
  }

  void commit() override {
    const std::size_t samples = arrays_.front().values.size();
    std::vector<NpyArray> all;
    for (const Array& a : arrays_) all.push_back({a.name, a.values.data(), samples, a.columns});
    write_npz(path_, all);
  }

 private:
  struct Array {
    std::string name;
    std::size_t columns;  // 0: of one dimension
    std::vector<double> values;
  };

  std::string path_;
  bool moment_;
  std::vector<Array> arrays_;
};

}  // namespace

std::unique_ptr<EstimatesWriter> estimates_writer(const std::string& path,
                                                  const std::vector<Replayed>& all, int dof) {
  if (path.ends_with(".npz")) return std::make_unique<NpzWriter>(path, all, dof);
  return std::make_unique<CsvWriter>(path, all, dof);
}

}  // namespace tauext
