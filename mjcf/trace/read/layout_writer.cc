// SPDX-License-Identifier: Apache-2.0
#include "mjcf/trace/read/layout_writer.h"

#include <fmt/format.h>
#ifdef TAUEXT_SQLITE
#include <sqlite3.h>
#endif

#include <bit>
#include <cmath>
#include <cstdint>
#include <memory>
#include <stdexcept>
#include <vector>

#include "mjcf/trace/atomic_file.h"
#include "mjcf/trace/byte_order.h"
#include "mjcf/trace/known.h"

namespace tauext {
namespace {

// how a program writes its rows
struct Layout {
  const char* name;
  double begin;                     // [s] of its clock
  const char *q, *qd, *tau, *head;  // names, {} for the joint from 0
  char separator;
  const char* number;  // how it writes one
};

constexpr Layout kLayouts[] = {
    {"libfranka", 125, "state.q[{}]", "state.dq[{}]", "state.tau_J[{}]", "time,success_rate", ',',
     "{:.6g}"},
    {"ur_rtde", 4021.5, "actual_q_{}", "actual_qd_{}", "actual_current_{}", "timestamp", ' ', "{}"},
    {"joint_state", 1.7e9, "", "", "", "", ' ', ""}};

std::string csv_of(const Trace& t, const Layout& layout, const Eigen::MatrixXd& torque) {
  fmt::memory_buffer out;
  const auto to = std::back_inserter(out);
  fmt::format_to(to, "{}", layout.head);
  for (const char* name : {layout.q, layout.qd, layout.tau}) {
    for (int j = 0; j < t.dof(); ++j)
      fmt::format_to(to, "{}{}", layout.separator, fmt::format(fmt::runtime(name), j));
  }
  if (!t.contact.empty()) fmt::format_to(to, "{}contact", layout.separator);
  const bool milliseconds = layout.name == std::string_view("libfranka");
  for (int k = 0; k < t.size(); ++k) {
    const double clock = layout.begin + t.t[static_cast<std::size_t>(k)];
    fmt::format_to(to, "\n");
    if (milliseconds) {
      fmt::format_to(to, "{},1", std::llround(1e3 * clock));
    } else {
      fmt::format_to(to, "{:.3f}", clock);
    }
    for (const Eigen::MatrixXd* m : {&t.q, &t.qd, &torque}) {
      for (int j = 0; j < t.dof(); ++j) {
        const double x = std::round((*m)(j, k) * 1e7) / 1e7;  // more no sensor knows
        fmt::format_to(to, "{}{}", layout.separator, fmt::format(fmt::runtime(layout.number), x));
      }
    }
    if (!t.contact.empty())
      fmt::format_to(to, "{}{}", layout.separator, int{t.contact[static_cast<std::size_t>(k)]});
  }
  fmt::format_to(to, "\n");
  return fmt::to_string(out);
}

#ifdef TAUEXT_SQLITE

// in CDR, low bytes first: each number at a multiple of its size, counted behind the first 4 bytes
class CdrText {
 public:
  template <class Unsigned>
  void put(Unsigned n) {
    while ((bytes_.size() - kHead) % sizeof n != 0) bytes_ += '\0';
    bytes_ += to_bytes(n, sizeof n);
  }
  void put(const std::string& text) {
    put(static_cast<std::uint32_t>(text.size() + 1));
    bytes_.append(text.c_str(), text.size() + 1);
  }
  template <class Column>
  void put_all(const Column& numbers) {
    put(static_cast<std::uint32_t>(numbers.size()));
    for (const double x : numbers) put(std::bit_cast<std::uint64_t>(x));
  }
  const std::string& bytes() const { return bytes_; }

 private:
  static constexpr std::size_t kHead = 4;
  std::string bytes_ = std::string("\0\1\0\0", kHead);
};

constexpr std::int64_t kPerSecond = 1'000'000'000;

std::string message_of(const Trace& t, int k, std::int64_t stamp,
                       const std::vector<std::string>& joints) {
  CdrText m;
  m.put(static_cast<std::uint32_t>(stamp / kPerSecond));
  m.put(static_cast<std::uint32_t>(stamp % kPerSecond));
  m.put(std::string("base"));
  m.put(static_cast<std::uint32_t>(joints.size()));
  for (const std::string& name : joints) m.put(name);
  m.put_all(t.q.col(k));
  m.put_all(t.qd.col(k));
  m.put_all(t.tau.col(k));
  return m.bytes();
}

class NewBag {
 public:
  NewBag() {
    sqlite3* db = nullptr;
    const int code = sqlite3_open(":memory:", &db);
    db_.reset(db);
    require(code);
  }

  void run(const char* sql) { require(sqlite3_exec(db_.get(), sql, nullptr, nullptr, nullptr)); }

  void insert(std::int64_t stamp, const std::string& message) {
    constexpr const char* kSql =
        "INSERT INTO messages (timestamp, topic_id, data) VALUES (?, 1, ?)";
    if (!insert_) {
      sqlite3_stmt* s = nullptr;
      require(sqlite3_prepare_v2(db_.get(), kSql, -1, &s, nullptr));
      insert_.reset(s);
    }
    sqlite3_bind_int64(insert_.get(), 1, stamp);
    sqlite3_bind_blob(insert_.get(), 2, message.data(), static_cast<int>(message.size()),
                      SQLITE_STATIC);
    if (sqlite3_step(insert_.get()) != SQLITE_DONE) require(SQLITE_ERROR);
    sqlite3_reset(insert_.get());
  }

  std::string bytes() {
    insert_.reset();
    sqlite3_int64 size = 0;
    const std::unique_ptr<unsigned char, decltype(&sqlite3_free)> data(
        sqlite3_serialize(db_.get(), "main", &size, 0), sqlite3_free);
    if (!data) require(SQLITE_NOMEM);
    return {reinterpret_cast<const char*>(data.get()), static_cast<std::size_t>(size)};
  }

 private:
  void require(int code) const {
    if (code != SQLITE_OK) throw std::runtime_error(sqlite3_errmsg(db_.get()));
  }

  std::unique_ptr<sqlite3, decltype(&sqlite3_close)> db_{nullptr, sqlite3_close};
  std::unique_ptr<sqlite3_stmt, decltype(&sqlite3_finalize)> insert_{nullptr, sqlite3_finalize};
};

#endif

// the bytes of a bag of ROS 2, as rosbag2_storage_sqlite3 writes it (schema 2, Foxy to Humble),
// with a sensor_msgs/JointState on /joint_states for each sample; begin: [s] of the clock at t = 0
std::string bag_of(const Trace& t, const std::vector<std::string>& joints, double begin) {
#ifdef TAUEXT_SQLITE
  NewBag db;
  db.run(
      "CREATE TABLE topics(id INTEGER PRIMARY KEY,name TEXT NOT NULL,type TEXT NOT NULL,"
      "serialization_format TEXT NOT NULL,offered_qos_profiles TEXT NOT NULL);"
      "CREATE TABLE messages(id INTEGER PRIMARY KEY,topic_id INTEGER NOT NULL,"
      "timestamp INTEGER NOT NULL,data BLOB NOT NULL);"
      "CREATE INDEX timestamp_idx ON messages (timestamp ASC);"
      "INSERT INTO topics(name,type,serialization_format,offered_qos_profiles) VALUES "
      "('/joint_states','sensor_msgs/msg/JointState','cdr','');"
      "BEGIN");
  for (int k = 0; k < t.size(); ++k) {
    const auto stamp = static_cast<std::int64_t>(
        std::llround((begin + t.t[static_cast<std::size_t>(k)]) * 1e6) * 1000);
    db.insert(stamp, message_of(t, k, stamp, joints));
  }
  db.run("COMMIT");
  return db.bytes();
#else
  static_cast<void>(t), static_cast<void>(joints), static_cast<void>(begin);
  throw std::runtime_error("bags of ROS 2 need SQLite at build (Debian: libsqlite3-dev)");
#endif
}

}  // namespace

void write_layout(const Trace& t, const std::string& layout, const Eigen::VectorXd& gain,
                  std::vector<std::string> joints, const std::string& path) {
  const Layout& l = find_known(kLayouts, "layout", layout, [](const Layout& x) { return x.name; });
  Eigen::MatrixXd torque = t.tau;
  if (layout == "ur_rtde") {
    if (gain.size() != t.dof() || (gain.array() == 0).any())
      throw std::invalid_argument(
          "the layout ur_rtde has currents: a robot file (.json) must say the `gain` of each "
          "drive");
    torque = gain.cwiseInverse().asDiagonal() * t.tau;
  }
  for (int j = static_cast<int>(joints.size()); j < t.dof(); ++j)
    joints.push_back(fmt::format("joint{}", j + 1));
  const std::string bytes =
      layout == "joint_state" ? bag_of(t, joints, l.begin) : csv_of(t, l, torque);
  AtomicFile file(path);
  file.write(bytes);
  file.commit();
}

}  // namespace tauext
