// SPDX-License-Identifier: Apache-2.0
#include "mjcf/trace/read/recording.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <deque>
#include <filesystem>
#include <map>
#include <optional>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "mjcf/trace/printable.h"
#include "mjcf/trace/read/bag/bag_messages.h"
#include "mjcf/trace/read/bag/bag_rows.h"
#include "mjcf/trace/read/bag/message_type.h"
#include "mjcf/trace/read/bag/parts.h"
#include "mjcf/trace/read/column_map.h"
#include "mjcf/trace/read/column_map_file.h"
#include "mjcf/trace/read/files/several_files.h"
#include "mjcf/trace/read/joined_rows.h"
#include "mjcf/trace/read/mat/mat_rows.h"
#include "mjcf/trace/read/numpy/npy_rows.h"
#include "mjcf/trace/read/text/csv_rows.h"
#include "mjcf/trace/read/text/unpacked_file.h"

namespace tauext {
namespace {

using Eigen::VectorXd;

// the first bytes of a file, which tell its format; none if it cannot be read
std::string magic_of(const std::string& path) {
  std::string bytes;
  if (const auto file = std::unique_ptr<std::FILE, int (*)(std::FILE*)>(
          std::fopen(path.c_str(), "rbe"), std::fclose)) {
    bytes.resize(512);
    bytes.resize(std::fread(bytes.data(), 1, bytes.size(), file.get()));
  }
  return bytes;
}

// a format that is not read, and what makes one that is of a file {0}
struct UnsupportedFormat {
  std::string_view magic, name, remedy;
};
constexpr std::string_view kOfWorkbook =
    "python3 -c \"import pandas; pandas.read_excel('{0}').to_csv('run.csv', index=False)\"";
constexpr UnsupportedFormat kUnsupported[] = {
    {"#ROSBAG", "a bag of ROS 1", "rosbags-convert --src {0} --dst new_bag (pip install rosbags)"},
    {"\x89HDF", "HDF5",
     "in Python, f = h5py.File('{0}') and numpy.savez('run.npz', t=f['t'], q=f['q'], ..)"},
    {"PAR1", "Parquet", "in Python, pandas.read_parquet('{0}').to_csv('run.csv', index=False)"},
    {"%PDF", "a PDF", "export a table as CSV"},
    {"\xFF\xFE", "text in UTF-16", "iconv -f UTF-16 -t UTF-8 {0} > run.csv"},
    {"\xFE\xFF", "text in UTF-16", "iconv -f UTF-16 -t UTF-8 {0} > run.csv"},
    {"version https://git-lfs", "a pointer of Git LFS in the place of its data", "git lfs pull"},
    {"\xD0\xCF\x11\xE0", "a workbook of old Excel", kOfWorkbook},
};

void refuse_unsupported(const std::string& path, const std::string& begin) {
  const auto fail = [&](std::string_view name, std::string_view remedy) {
    throw std::runtime_error(fmt::format("{}: is {}, which is not read: {}", path, name,
                                         fmt::format(fmt::runtime(remedy), path)));
  };
  for (const UnsupportedFormat& f : kUnsupported)
    if (begin.starts_with(f.magic)) fail(f.name, f.remedy);
  const bool zip = begin.starts_with("PK\x03\x04");
  if (zip &&
      (begin.find("[Content_Types].xml") != begin.npos || begin.find("_rels/") != begin.npos))
    fail("a workbook of Excel", kOfWorkbook);
  // without the mark before its letters
  const auto letter = [&](std::size_t i) { return begin[i] >= ' ' && begin[i] <= '~'; };
  for (const std::size_t first : {0U, 1U}) {
    const std::size_t other = 1 - first;
    if (begin.size() < 4 || !letter(first) || !letter(first + 2) || begin[other] != '\0' ||
        begin[other + 2] != '\0')
      continue;
    fail("text in UTF-16",
         fmt::format("iconv -f UTF-16{} -t UTF-8 {{0}} > run.csv", first == 0 ? "LE" : "BE"));
  }
}

// a text of numbers has no other letters below the blank
void refuse_binary(const std::string& path, const std::string& begin) {
  const auto odd = [](char c) {
    return c >= 0 && c < ' ' && std::string_view("\t\n\v\f\r").find(c) == std::string_view::npos;
  };
  if (std::none_of(begin.begin(), begin.end(), odd)) return;
  throw std::runtime_error(
      path +
      ": unknown format of recording; known: CSV, also as .gz, .xz, .zst, .bz2 "
      "or .lz4, .npy, .npz, .mat, .db3 and .mcap (ROS 2) or LCM");
}

bool begins_as_arrays(std::string_view begin) {
  return begin.starts_with("\x93NUMPY") || begin.starts_with("PK\x03\x04");
}
// the map of a recording where nobody names one
std::string usual_map(const std::string& path, const std::string& topic) {
  const std::string of_bag =
      is_bag(path) ? preset_of_messages(short_type_name(topic_of_bag(path, topic).type)) : "";
  return of_bag.empty() ? "tauext" : of_bag;
}

// "q[0]": numbers of a message that have no joints' names
bool is_numbered(const std::string& column) {
  return column.ends_with(']');
}

}  // namespace

std::unique_ptr<RowSource> open_rows(const std::string& path, const RecordingOptions& options,
                                     const CsvFormat& csv) {
  if (is_bag(path)) return std::make_unique<BagRows>(path, options.topic, options.joints);
  const std::string begin = magic_of(path);
  refuse_unsupported(path, begin);
  if (!options.topic.empty())
    throw std::invalid_argument(
        fmt::format("{}: has no channel '{}', as LCM logs have, and no topic, as ROS 2 bags have",
                    path, options.topic));
  if (begins_as_arrays(begin)) return std::make_unique<NpyRows>(path);
  if (begins_as_mat(begin)) return std::make_unique<MatRows>(path);
  if (is_compressed(begin)) {
    std::string inside(512, '\0');
    inside.resize(UnpackedFile(path).read(inside.data(), inside.size()));
    if (begins_as_arrays(inside) || begins_as_mat(inside))
      throw std::runtime_error(
          path + ": only text and bags are read from compressed files: unpack it first");
    refuse_unsupported(path, inside);
    refuse_binary(path, inside);
  } else {
    refuse_binary(path, begin);
  }
  return std::make_unique<CsvRows>(path, csv);
}

namespace detail {

// q through two poles at w [rad/s], then its difference: what stands for a velocity that nobody
// measured, some 2 / w late
class VelocityFilter {
 public:
  explicit VelocityFilter(double w) : w_(w) {}

  double delay() const { return 1 / w_; }  // [s] of a pole
  bool begun() const { return once_.size() > 0; }
  // at the first sample, as if the speed [rad/s] had been so before, in steps like the first [s]
  void begin(double t, const VectorXd& q, const VectorXd& speed, double step) {
    const double late = step / std::expm1(w_ * step);  // each pole
    once_ = q - late * speed, twice_ = once_ - late * speed;
    t_ = t;
  }
  // of the next one [rad/s]
  VectorXd operator()(double t, const VectorXd& q) {
    const double h = t - t_, a = std::exp(-w_ * h);
    t_ = t;
    once_ = a * once_ + (1 - a) * q;
    const VectorXd before = twice_;
    twice_ = a * twice_ + (1 - a) * once_;
    return (twice_ - before) / h;
  }

 private:
  double w_;  // [rad/s]
  double t_ = 0;
  VectorXd once_, twice_;
};

// rows that were left out for the numbers that they do not have
class Holes {
 public:
  Holes(const SampleLayout& layout, const RowSource& rows)
      : layout_(layout), columns_(rows.columns()), unit_(rows.unit()) {}

  void take(const std::vector<double>& sample, long line) {
    std::vector<std::size_t> missing;
    for (std::size_t i = 1; i < sample.size(); ++i)
      if (std::isnan(sample[i])) missing.push_back(i);
    if (missing.empty()) return;
    ++rows_;
    constexpr std::size_t kMost = 4;
    if (kinds_.size() == kMost && kinds_.count(missing) == 0) return;
    Kind& kind = kinds_[std::move(missing)];
    ++kind.rows;
    if (kind.lines.size() < 3) kind.lines.push_back(line);
  }

  std::int64_t rows() const { return rows_; }

  // which, and what to do where what one kind lacks another has, or rows that are whole
  std::string in_words(bool some_are_whole) const {
    std::string all;
    std::vector<std::size_t> in_none;
    for (const auto& [missing, kind] : kinds_) {
      all +=
          fmt::format("{}{} rows ({} {}{}) have no {}", all.empty() ? "" : ", ", kind.rows, unit_,
                      fmt::join(kind.lines, ", "), kind.rows > 3 ? " .." : "", listed(missing));
      if (&kind == &kinds_.begin()->second) in_none = missing;
      std::erase_if(in_none, [&lacks = missing](std::size_t i) {
        return !std::binary_search(lacks.begin(), lacks.end(), i);
      });
    }
    all = one_line(all, 700);
    if (!in_none.empty() && !some_are_whole)
      return fmt::format("{}; {} in none of them", all, one_line(listed(in_none), 400));
    return all +
           ": where these come from several topics, join = 0.005 in a map of columns takes each "
           "from the row nearest in time, within so many seconds";
  }

 private:
  struct Kind {
    std::int64_t rows = 0;
    std::vector<long> lines;  // the first few
  };

  std::string listed(const std::vector<std::size_t>& numbers) const {
    std::string all;
    for (const std::size_t i : numbers) {
      const std::string name = layout_.names[i].substr(0, layout_.names[i].find(']') + 1);
      if (all.find(name) != std::string::npos) continue;
      const auto column = static_cast<std::size_t>(layout_.rest[i - 1].column);
      all += fmt::format("{}{} (column '{}')", all.empty() ? "" : ", ", layout_.names[i],
                         printable_name(columns_[column]));
    }
    return all;
  }

  const SampleLayout& layout_;
  const std::vector<std::string>& columns_;
  std::string_view unit_;
  std::int64_t rows_ = 0;
  std::map<std::vector<std::size_t>, Kind> kinds_;  // by the numbers that they lack
};

}  // namespace detail

struct RecordingReader::Impl {
  Impl(const std::string& file, const RecordingOptions& o)
      : path(file),
        joints(o.joints),
        map(column_map(!o.columns.empty() ? o.columns : usual_map(path, o.topic))),
        options{o.columns, o.topic,
                map.leaves_order_open() ? o.joints : std::vector<std::string>()},
        rows(open()),
        layout(layout_of(known(), rows->columns(), path, map.rate() == 0)),
        holes(layout, *rows),
        timed(0, skipped),
        filter(map.velocity_filter()) {
    rows->read_only(layout.columns());
    skipped.unit = rows->unit();
    if (map.join() > 0) joined.emplace(path, map.join(), layout.names, pace(), skipped);
    contents = {layout.dof,          layout.instants,
                layout.currents,     layout.without_gravity,
                layout.tau_ext >= 0, layout.driver >= 0,
                layout.contact >= 0, layout.qd < 0 ? 2 / map.velocity_filter() : 0};
    if (layout.qd < 0) {
      skipped.notes.push_back(fmt::format(
          "no qd: it is made of q by two poles at {:g} rad/s and a difference (velocity_filter)",
          map.velocity_filter()));
    }
  }

  std::unique_ptr<RowSource> open() const {
    const auto open_one = [this](const std::string& one) { return open_rows(one, options, csv()); };
    if (!map.parts().empty()) return parts_in(path, map.parts(), open_one);
    if (map.files().empty()) return open_one(path);
    const bool is_folder = std::filesystem::is_directory(path);
    if (is_folder && map.needs_first_file())
      throw std::runtime_error(
          path + ": is a folder, and not every quantity of the map names its `file` in it");
    return side_by_side(is_folder ? path : std::filesystem::path(path).parent_path().string(),
                        is_folder ? "" : path, map.files(), open_one);
  }

  CsvFormat csv() const {
    CsvFormat format = map.csv();
    format.finite = false, format.holes = true;  // which are counted here
    return format;
  }

  // the number whose rows are the samples where rows are joined: the torque's, unless something
  // else comes much more rarely, which would have to be taken for several samples
  std::size_t pace() const {
    const std::unique_ptr<RowSource> again = open();
    again->read_only(layout.columns());
    std::vector<std::int64_t> count(layout.names.size());
    SkippedRows of_no_matter;
    for (std::vector<double> one, sample; again->next(one, of_no_matter);) {
      layout.convert(one, sample);
      for (std::size_t i = 0; i < count.size(); ++i) count[i] += !std::isnan(sample[i]);
    }
    const auto rarest = std::min_element(count.begin(), count.end());
    if (*rarest == 0) {
      const auto i = static_cast<std::size_t>(rarest - count.begin());
      throw std::runtime_error(fmt::format("{}: no row has {}: column '{}' is empty throughout",
                                           path, layout.names[i], printable_name(column_of(i))));
    }
    const auto tau = static_cast<std::size_t>(layout.tau);
    const bool much_more = 2 * count[tau] > 3 * *rarest;
    return much_more ? static_cast<std::size_t>(rarest - count.begin()) : tau;
  }

  // from which a number of a sample comes
  const std::string& column_of(std::size_t i) const {
    return rows->columns()[static_cast<std::size_t>(i == 0 ? layout.t.at(0).first
                                                           : layout.rest[i - 1].column)];
  }

  // what the map finds
  MappedColumns known() {
    MappedColumns all = map.mapped(rows->columns(), path, joints, &skipped.notes);
    for (std::string& missing : map.missing_in(all)) skipped.notes.push_back(std::move(missing));
    if (map.rate() > 0)
      skipped.notes.push_back(
          fmt::format("the time is counted, {:g} rows a second, as the map says", map.rate()));
    if (std::string note = map.choose_torque(all, rows->columns()); !note.empty())
      skipped.notes.push_back(std::move(note));
    const std::vector<int>& q = all.at("q").columns;
    if (is_bag(path) && joints.empty() && map.leaves_order_open() && q.size() > 1 &&
        !is_numbered(rows->columns()[static_cast<std::size_t>(q[0])]))
      skipped.notes.push_back(
          "no joints' names to compare with: their order is that of the first message");
    return all;
  }

  bool read_row() {
    const std::int64_t before = skipped.total();
    const bool any = rows->next(raw, skipped);
    row_count += skipped.total() - before + 1;
    return any;
  }

  // false if the source is at its end
  bool take_row() {
    if (!read_row()) return false;
    std::vector<double> sample = timed.spare();
    layout.convert(raw, sample);
    if (map.rate() > 0) sample[0] = static_cast<double>(row_count - 1) / map.rate();
    if (joined) {
      joined->take(std::move(sample), rows->number());
      take_joined();
    } else {
      take_sample(std::move(sample), rows->number());
    }
    return true;
  }

  void take_sample(std::vector<double> sample, long line) {
    const auto odd =
        std::find_if_not(sample.begin(), sample.end(), [](double x) { return std::isfinite(x); });
    if (odd == sample.end()) return timed.take(std::move(sample), line);
    ++skipped.not_finite;
    skipped.say(
        line,
        fmt::format("column '{}' is empty or not finite",
                    printable_name(column_of(static_cast<std::size_t>(odd - sample.begin())))));
    holes.take(sample, line);
  }

  void take_joined() {
    long line = 0;
    for (std::vector<double> sample; joined->next(sample, line);)
      take_sample(std::move(sample), line);
  }

  void finish() {
    if (joined) {
      joined->finish();
      take_joined();
      skipped.notes.push_back(joined->in_words());
    }
    timed.finish();
    ended = true;
  }

  // where most rows lack something
  void note_holes() {
    if (!std::exchange(noted, true) && holes.rows() > counter.so_far().samples)
      skipped.notes.push_back(holes.in_words(true));
  }

  // false at the end
  bool next_row() {
    if (!kept.empty()) {
      row = std::move(kept.front());
      kept.pop_front();
      return true;
    }
    while (!timed.next(row)) {
      if (ended) return false;
      if (!take_row()) finish();
    }
    return true;
  }

  // by the mean speed [rad/s] over a pole's delay, which is returned; 0 over a gap
  VectorXd begin_filter() {
    const auto q = [this] { return VectorXd(VectorXd::Map(row.data() + layout.q, layout.dof)); };
    std::vector<double> first = row;
    std::deque<std::vector<double>> next;
    const VectorXd from = q();
    VectorXd speed = VectorXd::Zero(layout.dof);
    double step = filter.delay();
    while (row[0] < first[0] + filter.delay() && next_row()) {
      const double h = row[0] - first[0];
      const VectorXd way = q() - from;
      if (h < 5 * filter.delay() && way.cwiseAbs().maxCoeff() < 3) speed = way / h;
      if (next.empty()) step = h;
      next.push_back(row);
    }
    kept = std::move(next);
    row = std::move(first);
    filter.begin(row[0], from, speed, step);
    return speed;
  }

  void fill(RecordedSample& s) {
    const auto copy = [&](Eigen::VectorXd& to, int at, int count) {
      if (at >= 0) to = VectorXd::Map(row.data() + at, count);
    };
    s.t = row[0];
    copy(s.q, layout.q, layout.dof);
    copy(s.qd, layout.qd, layout.dof);
    if (layout.qd < 0) s.qd = filter.begun() ? filter(s.t, s.q) : begin_filter();
    copy(s.tau, layout.tau, layout.dof);
    copy(s.tau_ext, layout.tau_ext, layout.dof);
    copy(s.driver, layout.driver, layout.dof);
    copy(s.force, layout.force, 3);
    s.contact = layout.contact >= 0 && row[static_cast<std::size_t>(layout.contact)] != 0;
    counter.take(s.t, s.q, s.qd, s.tau);
  }

  [[noreturn]] void fail_empty() const {
    std::string why;
    if (holes.rows() > 0) why = "; " + holes.in_words(false);
    if (joined)
      why = "; with `join`, rows are in the order of their times, which are those of one clock";
    throw std::runtime_error(fmt::format("{}: no usable row ({} skipped{}{}){}", path,
                                         skipped.total(), skipped.first.empty() ? "" : "; ",
                                         skipped.first.empty() ? "" : skipped.first[0], why));
  }

  std::string path;
  std::vector<std::string> joints;  // of the robot
  RecordingContents contents;
  SkippedRows skipped;
  std::vector<double> raw, row;
  std::deque<std::vector<double>> kept;  // the rows behind it that were read already
  bool ended = false, noted = false;
  std::int64_t row_count = 0;  // with those that could not be read
  ColumnMap map;
  RecordingOptions options;  // of the rows
  std::unique_ptr<RowSource> rows;
  SampleLayout layout;
  detail::Holes holes;
  std::optional<JoinedRows> joined;
  TimedRows timed;
  detail::VelocityFilter filter;
  RegularityCounter counter;
};

RecordingReader::RecordingReader(const std::string& path, const RecordingOptions& options)
    : impl_(std::make_unique<Impl>(path, options)) {}
RecordingReader::~RecordingReader() = default;

const RecordingContents& RecordingReader::contents() const {
  return impl_->contents;
}
const SkippedRows& RecordingReader::skipped() const {
  return impl_->skipped;
}
const Regularity& RecordingReader::regularity() const {
  return impl_->counter.so_far();
}

bool RecordingReader::next(RecordedSample& s) {
  Impl& r = *impl_;
  if (!r.next_row()) {
    if (r.counter.so_far().samples == 0) r.fail_empty();
    r.note_holes();
    return false;
  }
  r.fill(s);
  return true;
}

Trace trace_of(SampleSource& source) {
  const RecordingContents& has = source.contents();
  Trace trace;
  std::vector<double> q, qd, tau, tau_ext, driver, force;
  const auto append = [](std::vector<double>& to, const VectorXd& v) {
    to.insert(to.end(), v.begin(), v.end());
  };
  for (RecordedSample s; source.next(s);) {
    trace.t.push_back(s.t);
    append(q, s.q), append(qd, s.qd), append(tau, s.tau);
    append(tau_ext, s.tau_ext), append(driver, s.driver), append(force, s.force);
    if (has.has_contact) trace.contact.push_back(s.contact);
  }
  const auto matrix = [&](const std::vector<double>& all) -> Eigen::MatrixXd {
    if (all.empty()) return {};
    return Eigen::MatrixXd::Map(all.data(), has.dof, trace.size());
  };
  trace.q = matrix(q), trace.qd = matrix(qd), trace.tau = matrix(tau);
  trace.tau_ext = matrix(tau_ext), trace.tau_ext_of_driver = matrix(driver);
  if (!force.empty()) trace.force = Eigen::Matrix3Xd::Map(force.data(), 3, trace.size());
  trace.torque_at_instants = has.torque_at_instants;
  trace.tau_is_current = has.tau_is_current;
  trace.tau_without_gravity = has.without_gravity;
  return trace;
}

Trace read_recording(const std::string& path, const RecordingOptions& options, SkippedRows* skipped,
                     Regularity* regularity) {
  RecordingReader reader(path, options);
  Trace trace = trace_of(reader);
  *skipped = reader.skipped();
  if (regularity != nullptr) *regularity = reader.regularity();
  return trace;
}

}  // namespace tauext
