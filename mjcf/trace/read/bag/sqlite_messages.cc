// SPDX-License-Identifier: Apache-2.0
#include "mjcf/trace/read/bag/sqlite_messages.h"

#include <fmt/format.h>
#ifdef TAUEXT_SQLITE
#include <fcntl.h>
#include <sqlite3.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>
#endif

#include <algorithm>
#include <array>
#include <filesystem>
#include <new>
#include <stdexcept>
#include <vector>

#include "mjcf/trace/byte_order.h"
#include "mjcf/trace/printable.h"
#include "mjcf/trace/read/text/byte_file.h"

namespace tauext {

#ifdef TAUEXT_SQLITE
namespace {

using Connection = std::unique_ptr<sqlite3, decltype(&sqlite3_close)>;
using Statement = std::unique_ptr<sqlite3_stmt, decltype(&sqlite3_finalize)>;

// SQLite takes what is missing of a page for zeros: "Database File Format", 1.3
void refuse_cut_off(const ByteFile& file) {
  std::array<unsigned char, 100> header{};
  const std::size_t size = std::min<std::uint64_t>(file.size(), header.size());
  file.read(0, header.data(), size);
  const auto number = [&](int at, int bytes) {
    return from_bytes(&header[at], bytes, std::endian::big);
  };
  const std::uint64_t page = number(16, 2) == 1 ? 65536 : number(16, 2);
  const std::uint64_t whole = number(24, 4) == number(92, 4) ? page * number(28, 4) : header.size();
  const std::string remedy = fmt::format(
      "; sqlite3 {} .dump | sed 's/^ROLLBACK.*/COMMIT;/' | sqlite3 whole.db3 saves what SQLite "
      "still "
      "finds in it",
      file.path());
  if (file.size() < whole)
    file.fail(fmt::format("is cut off: {} of {} bytes{}", file.size(), whole, remedy));
  if (page == 0 || file.size() % page != 0) file.fail("is cut off within a page" + remedy);
}

// these would have to be written into the file, or be missed
void refuse_unfinished(const std::string& path) {
  for (const char* end : {"-wal", "-journal"}) {
    struct stat rest {};
    if (::stat((path + end).c_str(), &rest) != 0 || rest.st_size == 0) continue;
    throw std::runtime_error(
        fmt::format("{0}: was not closed, and {0}{1} holds a part of it: bring them together by "
                    "sqlite3 {0} 'PRAGMA quick_check'",
                    path, end));
  }
}

std::string uri_of(const std::string& path) {
  std::string uri = "file://";
  for (const char c : std::filesystem::absolute(path).string()) {
    const bool plain = c == '/' || c == '.' || c == '-' || c == '_' || (c >= '0' && c <= '9') ||
                       (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z');
    uri += plain ? std::string{c} : fmt::format("%{:02X}", static_cast<unsigned char>(c));
  }
  return uri + "?mode=ro&immutable=1";  // without locks, and nothing beside it
}

[[noreturn]] void fail_as(sqlite3* db, const std::string& path) {
  throw std::runtime_error(fmt::format("{}: {}", path, one_line(sqlite3_errmsg(db), 200)));
}

// The bytes of a file that has no name, which SQLite cannot open.
class Mapped {
 public:
  explicit Mapped(const std::string& path) : size_(ByteFile(path).size()) {
    const int fd = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
    bytes_ = ::mmap(nullptr, size_, PROT_READ | PROT_WRITE, MAP_PRIVATE, fd, 0);
    ::close(fd);
    if (bytes_ == MAP_FAILED) throw std::bad_alloc();
    // no log is beside it, so its header must not ask for one: "Database File Format", 1.3.3
    std::fill_n(static_cast<unsigned char*>(bytes_) + 18, 2, 1);
  }
  ~Mapped() { ::munmap(bytes_, size_); }
  Mapped(const Mapped&) = delete;
  Mapped& operator=(const Mapped&) = delete;

  int give(sqlite3* db) const {
    const auto size = static_cast<sqlite3_int64>(size_);
    return sqlite3_deserialize(db, "main", static_cast<unsigned char*>(bytes_), size, size,
                               SQLITE_DESERIALIZE_READONLY);
  }

 private:
  std::size_t size_;
  void* bytes_ = nullptr;
};

bool has_name(const std::string& path) {
  struct stat file {};
  return ::stat(path.c_str(), &file) != 0 || file.st_nlink > 0;
}

Connection open_database(const std::string& path, std::unique_ptr<Mapped>& mapped) {
  refuse_cut_off(ByteFile(path));
  refuse_unfinished(path);
  if (!has_name(path)) mapped = std::make_unique<Mapped>(path);
  sqlite3* db = nullptr;
  int code = sqlite3_open_v2(
      mapped ? ":memory:" : uri_of(path).c_str(), &db,
      mapped ? SQLITE_OPEN_READWRITE : SQLITE_OPEN_READONLY | SQLITE_OPEN_URI, nullptr);
  if (code == SQLITE_OK && mapped) code = mapped->give(db);
  Connection connection(db, sqlite3_close);
  if (db == nullptr) throw std::bad_alloc();
  if (code != SQLITE_OK) fail_as(db, path);
  sqlite3_db_config(db, SQLITE_DBCONFIG_DEFENSIVE, 1, nullptr);
  sqlite3_db_config(db, SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0, nullptr);
  sqlite3_db_config(db, SQLITE_DBCONFIG_ENABLE_LOAD_EXTENSION, 0, nullptr);
  sqlite3_db_config(db, SQLITE_DBCONFIG_ENABLE_TRIGGER, 0, nullptr);
  sqlite3_db_config(db, SQLITE_DBCONFIG_ENABLE_VIEW, 0, nullptr);
  sqlite3_limit(db, SQLITE_LIMIT_LENGTH, 2 * BagMessages::kMost);
  return connection;
}

Statement prepare(sqlite3* db, const std::string& path, const std::string& sql) {
  sqlite3_stmt* statement = nullptr;
  if (sqlite3_prepare_v2(db, sql.c_str(), -1, &statement, nullptr) != SQLITE_OK) fail_as(db, path);
  return {statement, sqlite3_finalize};
}

// false at the end
bool step(sqlite3* db, const std::string& path, sqlite3_stmt* statement) {
  const int code = sqlite3_step(statement);
  if (code != SQLITE_ROW && code != SQLITE_DONE) fail_as(db, path);
  return code == SQLITE_ROW;
}

std::string_view bytes_in(sqlite3_stmt* statement, int column) {
  const void* const bytes = sqlite3_column_blob(statement, column);  // nullptr: none
  const int size = sqlite3_column_bytes(statement, column);
  return bytes == nullptr
             ? std::string_view()
             : std::string_view(static_cast<const char*>(bytes), static_cast<std::size_t>(size));
}

// tables alone: a view or a virtual table may compute for ever
bool has_table(sqlite3* db, const std::string& path, const char* name) {
  const Statement s = prepare(db, path,
                              fmt::format("SELECT 1 FROM sqlite_master WHERE type = 'table' AND "
                                          "rootpage > 0 AND name = '{}'",
                                          name));
  return step(db, path, s.get());
}

void refuse_other_schemas(sqlite3* db, const std::string& path) {
  if (has_table(db, path, "topics") && has_table(db, path, "messages")) return;
  throw std::runtime_error(
      fmt::format("{}: is no bag of ROS 2: it lacks the tables topics and messages", path));
}

std::vector<BagTopic> topics_in(sqlite3* db, const std::string& path) {
  constexpr std::size_t kMostTopics = 10000;
  const Statement s = prepare(db, path, "SELECT name, type, serialization_format FROM topics");
  std::vector<BagTopic> topics;
  while (topics.size() < kMostTopics && step(db, path, s.get())) {
    topics.push_back({std::string(bytes_in(s.get(), 0)), std::string(bytes_in(s.get(), 1)),
                      std::string(bytes_in(s.get(), 2))});
  }
  return topics;
}

class SqliteMessages final : public BagMessages {
 public:
  explicit SqliteMessages(const std::string& file)
      : file_(file), connection_(open_database(file, mapped_)) {
    refuse_other_schemas(connection_.get(), file);
    add_topics(topics_in(connection_.get(), file));
  }

  bool next(BagMessage& message) override {
    constexpr std::int64_t kNanoseconds = 1000000000;  // [1/s]
    sqlite3_stmt* const s = messages_.get();
    at_end_ = at_end_ || !step(connection_.get(), file_, s);
    if (at_end_) return false;
    const std::int64_t t = sqlite3_column_int64(s, 0), seconds = t / kNanoseconds;
    message.received =
        static_cast<double>(seconds) + 1e-9 * static_cast<double>(t - seconds * kNanoseconds);
    message.size = sqlite3_column_int64(s, 1);
    message.bytes = bytes_in(s, 2);
    message.channel = sqlite3_column_int64(s, 3);
    return true;
  }

  void rewind() override {
    sqlite3_reset(messages_.get());
    at_end_ = false;
  }

 private:
  // which must outlive the statement
  static void bind(const Statement& s, int at, const std::string& text) {
    sqlite3_bind_text(s.get(), at, text.data(), static_cast<int>(text.size()), SQLITE_STATIC);
  }

  void select() override {
    sqlite3* const db = connection_.get();
    // length() of a BLOB does not read it
    messages_ = prepare(
        db, file_,
        fmt::format("SELECT timestamp, length(data), CASE WHEN length(data) <= {} THEN data END, "
                    "topic_id FROM messages WHERE topic_id IN (SELECT id FROM topics WHERE "
                    "instr(',' || ?1 || ',', ',' || name || ',') > 0 AND serialization_format = ?3 "
                    "AND (?3 = 'json' OR replace(type, '/msg/', '/') = "
                    "replace(?2, '/msg/', '/'))) ORDER BY timestamp, id",
                    kMost));
    bind(messages_, 1, topic().name), bind(messages_, 2, topic().type);
    bind(messages_, 3, topic().format);
    at_end_ = false;
    if (has_table(db, file_, "message_definitions")) find_definition();
  }

  void find_definition() {
    sqlite3* const db = connection_.get();
    const Statement s = prepare(db, file_,
                                fmt::format("SELECT encoding, encoded_message_definition FROM "
                                            "message_definitions WHERE topic_type = ?1 AND "
                                            "length(encoded_message_definition) BETWEEN 1 AND {}",
                                            kMost));
    bind(s, 1, topic().type);
    if (step(db, file_, s.get()))
      set_definition(std::string(bytes_in(s.get(), 0)), std::string(bytes_in(s.get(), 1)));
  }

  std::string file_;
  std::unique_ptr<Mapped> mapped_;  // which must outlive the connection
  Connection connection_;
  Statement messages_{nullptr, sqlite3_finalize};
  bool at_end_ = false;
};

}  // namespace

std::unique_ptr<BagMessages> open_sqlite_bag(const std::string& path) {
  return std::make_unique<SqliteMessages>(path);
}

#else

std::unique_ptr<BagMessages> open_sqlite_bag(const std::string& path) {
  throw std::runtime_error(
      path +
      ": bags of the storage sqlite3 are left out of this build: install Debian's libsqlite3-dev, "
      "and build again");
}

#endif

}  // namespace tauext
