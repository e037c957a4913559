// SPDX-License-Identifier: Apache-2.0
#include "bench/replay/estimates_writer.h"

#include <fmt/compile.h>
#include <fmt/format.h>

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <iterator>
#include <limits>
#include <optional>
#include <utility>

#include "bench/logs/mcap_samples.h"
#include "mjcf/trace/atomic_file.h"
#include "mjcf/trace/read/bag/json_message.h"
#include "mjcf/trace/read/bag/mcap_writer.h"
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
    for (int i = from; i < from + n; ++i) fmt::format_to(to, FMT_COMPILE(",{:.9g}"), v[i]);
  };
  add(a.force.force, 0, 3);
  if (components == 6) add(a.force.moment, 0, 3);
  add(a.force.seen, 0, components);
  fmt::format_to(to, FMT_COMPILE(",{:.9g},{}"), a.force.left_over, a.touch.link + 1);
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

  void add(const RecordedSample& y, const Eigen::VectorXd&,
           const std::vector<Replayed>& all) override {
    const auto to = std::back_inserter(out_);
    fmt::format_to(to, FMT_COMPILE("{}"), y.t);
    for (const Replayed& c : all) {
      for (const double d : c.tau_ext()) fmt::format_to(to, FMT_COMPILE(",{}"), d);
      fmt::format_to(to, FMT_COMPILE(",{}"), static_cast<int>(c.last().status));
      if (!c.detector().empty())
        fmt::format_to(to, FMT_COMPILE(",{}"), int{c.last().detection.mark});
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

  void add(const RecordedSample& y, const Eigen::VectorXd&,
           const std::vector<Replayed>& all) override {
    std::size_t next = 0;
    const auto put = [&](std::initializer_list<double> row) {
      std::vector<double>& to = arrays_[next++].values;
      to.insert(to.end(), row);
    };
    put({y.t});
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

// the log, and a topic for each estimator
class McapEstimates final : public EstimatesWriter {
 public:
  McapEstimates(const std::string& path, const RecordingContents& log)
      : path_(path), log_(log), moment_(log.dof >= kJointsOfMoment), file_(path) {}

  void add(const RecordedSample& y, const Eigen::VectorXd& tau,
           const std::vector<Replayed>& all) override {
    if (!samples_) {
      samples_.emplace(file_, log_, y, path_);
      for (const Replayed& c : all) topics_.push_back(file_.add(topic_of(c)));
    }
    samples_->write(y, tau);
    for (std::size_t i = 0; i < all.size(); ++i) {
      const Replayed& c = all[i];
      message_.clear();
      message_.put("t", y.t);
      message_.put("tau_ext", c.tau_ext().data(), static_cast<std::size_t>(c.tau_ext().size()));
      message_.put("status", static_cast<std::int64_t>(c.last().status));
      if (!c.detector().empty()) message_.put("mark", std::int64_t{c.last().detection.mark});
      if (c.finds_forces()) put_forces(c.acting());
      file_.write(topics_[i], y.t, message_.finish());
    }
  }

  void commit() override { file_.commit(); }

 private:
  McapTopic topic_of(const Replayed& c) const {
    std::vector<JsonField> fields{
        {"t", false, "[s] the time of the sample"},
        {"tau_ext", true, "[N m] estimate of each joint, sign of equation (3)"},
        {"status", false, "0 ok, 1 started, ..: tauext-replay --help"}};
    const auto add = [&](const char* name, bool many, const char* what) {
      fields.push_back({name, many, what});
    };
    if (!c.detector().empty()) add("mark", false, "1 where the detector marks a collision");
    if (c.finds_forces()) {
      add("force", true, "[N] on the arm at the site, axes of the base");
      if (moment_) add("moment", true, "[N m] about the site");
      add("seen", true, "[1] how much of each component the joints see");
      add("left_over", false, "[N m] of tau_ext that no force at the site explains");
      add("link", false, "joint from 1 whose link is touched; 0: none");
      if (moment_) {
        add("line_point", true, "[m] of the line along which the force acts; null: unknown");
        add("line_direction", true, "[1] of that line; null: unknown");
      }
    }
    const std::string type = "tauext.Estimate";
    McapTopic topic{"/estimate/" + c.estimator(), type, json_schema(type, fields), {}};
    topic.metadata["estimator"] = c.estimator();
    if (!c.detector().empty()) topic.metadata["detector"] = c.detector();
    return topic;
  }

  void put_forces(const Acting& a) {
    const auto put = [&](const char* name, const auto& v, std::size_t count) {
      message_.put(name, v.data(), count);
    };
    put("force", a.force.force, 3);
    if (moment_) put("moment", a.force.moment, 3);
    put("seen", a.force.seen, moment_ ? 6 : 3);
    message_.put("left_over", a.force.left_over);
    message_.put("link", std::int64_t{a.touch.link} + 1);
    if (!moment_) return;
    const Eigen::Vector3d unknown =
        Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
    put("line_point", a.touch.has_line ? a.touch.line.point : unknown, 3);
    put("line_direction", a.touch.has_line ? a.touch.line.direction : unknown, 3);
  }

  std::string path_;
  RecordingContents log_;
  bool moment_;
  McapWriter file_;
  std::optional<McapSamples> samples_;  // from the first one on
  std::vector<std::size_t> topics_;     // of the estimators
  JsonMessage message_;
};

}  // namespace

std::unique_ptr<EstimatesWriter> estimates_writer(const std::string& path,
                                                  const std::vector<Replayed>& all,
                                                  const RecordingContents& log) {
  if (path.ends_with(".npz")) return std::make_unique<NpzWriter>(path, all, log.dof);
  if (path.ends_with(".mcap")) return std::make_unique<McapEstimates>(path, log);
  return std::make_unique<CsvWriter>(path, all, log.dof);
}

}  // namespace tauext
