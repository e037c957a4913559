// SPDX-License-Identifier: Apache-2.0
// Bags as rosbag2_storage_sqlite3 makes them, by the SQL of its sqlite_storage.cpp.
#pragma once

#include <gtest/gtest.h>
#include <sqlite3.h>

#include <cstring>
#include <string>
#include <vector>

#include "mjcf/trace/read/test/recording.h"

namespace tauext::test {

class SomeBag {
 public:
  explicit SomeBag(const std::string& path) {
    EXPECT_EQ(sqlite3_open(path.c_str(), &db_), SQLITE_OK);
    run("PRAGMA page_size = 512");
    run("PRAGMA synchronous = OFF");
  }
  ~SomeBag() { sqlite3_close(db_); }
  SomeBag(const SomeBag&) = delete;
  SomeBag& operator=(const SomeBag&) = delete;

  void run(const std::string& sql) {
    char* error = nullptr;
    EXPECT_EQ(sqlite3_exec(db_, sql.c_str(), nullptr, nullptr, &error), SQLITE_OK) << error;
  }
  // schema version 2, Foxy to Humble
  void make_tables() {
    run("CREATE TABLE topics(id INTEGER PRIMARY KEY,name TEXT NOT NULL,type TEXT NOT NULL,"
        "serialization_format TEXT NOT NULL,offered_qos_profiles TEXT NOT NULL)");
    run("CREATE TABLE messages(id INTEGER PRIMARY KEY,topic_id INTEGER NOT NULL,timestamp INTEGER "
        "NOT NULL, data BLOB NOT NULL)");
    run("CREATE INDEX timestamp_idx ON messages (timestamp ASC)");
  }
  // schema version 4, Iron and later
  void make_newer_tables() {
    run("CREATE TABLE schema(schema_version INTEGER PRIMARY KEY,ros_distro TEXT NOT NULL)");
    run("CREATE TABLE metadata(id INTEGER PRIMARY KEY,metadata_version INTEGER NOT NULL,metadata "
        "TEXT NOT NULL)");
    run("CREATE TABLE topics(id INTEGER PRIMARY KEY,name TEXT NOT NULL,type TEXT NOT NULL,"
        "serialization_format TEXT NOT NULL,offered_qos_profiles TEXT NOT NULL,"
        "type_description_hash TEXT NOT NULL DEFAULT '')");
    run("CREATE TABLE message_definitions(id INTEGER PRIMARY KEY,topic_type TEXT NOT NULL,encoding "
        "TEXT NOT NULL,encoded_message_definition TEXT NOT NULL,type_description_hash TEXT NOT "
        "NULL)");
    run("CREATE TABLE messages(id INTEGER PRIMARY KEY,topic_id INTEGER NOT NULL,timestamp INTEGER "
        "NOT NULL, data BLOB NOT NULL)");
    run("CREATE INDEX timestamp_idx ON messages (timestamp ASC)");
    run("INSERT INTO schema (schema_version, ros_distro) VALUES (4, 'rolling')");
  }
  void add_topic(const std::string& name, const std::string& type = "sensor_msgs/msg/JointState",
                 const std::string& format = "cdr") {
    run("INSERT INTO topics(name,type,serialization_format,offered_qos_profiles) VALUES ('" + name +
        "','" + type + "','" + format + "','')");
  }
  void add_message(int topic, long long nanoseconds, const std::string& data) {
    sqlite3_stmt* s = nullptr;
    EXPECT_EQ(
        sqlite3_prepare_v2(db_, "INSERT INTO messages (timestamp, topic_id, data) VALUES (?, ?, ?)",
                           -1, &s, nullptr),
        SQLITE_OK);
    sqlite3_bind_int64(s, 1, nanoseconds);
    sqlite3_bind_int(s, 2, topic);
    sqlite3_bind_blob(s, 3, data.data(), static_cast<int>(data.size()), SQLITE_TRANSIENT);
    EXPECT_EQ(sqlite3_step(s), SQLITE_DONE);
    sqlite3_finalize(s);
  }

 private:
  sqlite3* db_ = nullptr;
};

// A message in CDR, by the rules of OMG's standard (formal/02-06-51, 15.3): each number at a
// multiple of its size, counted behind the first 4 bytes.
class SomeMessage {
 public:
  explicit SomeMessage(bool big = false) : big_(big), bytes_(big ? 0 : 1, '\0') {
    bytes_ = {'\0', big ? '\0' : '\1', '\0', '\0'};
  }

  SomeMessage& number(unsigned long long n, std::size_t size) {
    while (bytes_.size() % size != 4 % size) bytes_ += '\0';
    const std::string low = low_first(n, static_cast<int>(size));
    bytes_ += big_ ? std::string(low.rbegin(), low.rend()) : low;
    return *this;
  }
  SomeMessage& stamp(unsigned seconds, unsigned nanoseconds) {
    return number(seconds, 4).number(nanoseconds, 4);
  }
  SomeMessage& text(const std::string& s) {
    number(s.size() + 1, 4);
    bytes_ += s + std::string(1, '\0');
    return *this;
  }
  SomeMessage& texts(const std::vector<std::string>& all) {
    number(all.size(), 4);
    for (const std::string& s : all) text(s);
    return *this;
  }
  SomeMessage& numbers(const std::vector<double>& all) {
    number(all.size(), 4);
    for (const double x : all) {
      unsigned long long bits = 0;
      std::memcpy(&bits, &x, sizeof bits);
      number(bits, 8);
    }
    return *this;
  }
  std::string bytes() const { return bytes_; }

 private:
  bool big_;
  std::string bytes_;
};

}  // namespace tauext::test
