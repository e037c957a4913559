// SPDX-License-Identifier: Apache-2.0
// What a program reads and what it writes.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>
#include <stdexcept>
#include <string>

#include "mjcf/test/error_of.h"
#include "mjcf/trace/atomic_file.h"
#include "mjcf/trace/input_file.h"
#include "mjcf/trace/timed_rows.h"
#include "mjcf/trace/trace.h"

namespace tauext::test {
namespace {

namespace fs = std::filesystem;

class Files : public testing::Test {
 protected:
  Files() : folder_(fs::temp_directory_path() / ("tauext_files_" + std::to_string(::getpid()))) {
    fs::create_directories(folder_);
  }
  ~Files() override { fs::remove_all(folder_); }

  std::string path(const std::string& name = "out") const { return (folder_ / name).string(); }
  void put(const std::string& text, const std::string& name = "out") const {
    std::ofstream(path(name)) << text;
  }
  std::string get(const std::string& name = "out") const {
    std::ostringstream out;
    out << std::ifstream(path(name)).rdbuf();
    return out.str();
  }
  std::set<std::string> names() const {
    std::set<std::string> all;
    for (const auto& e : fs::directory_iterator(folder_)) all.insert(e.path().filename().string());
    return all;
  }

  fs::path folder_;
};

TEST_F(Files, AppearWholeOrNotAtAll) {
  put("old");
  {
    AtomicFile file(path());
    file.write("new");
    EXPECT_EQ(get(), "old");
  }
  EXPECT_EQ(get(), "old");
  AtomicFile file(path());
  file.write("new");
  file.commit();
  EXPECT_EQ(get(), "new");
  EXPECT_EQ(names(), std::set<std::string>{"out"});
}

TEST_F(Files, KeepModeAndOwnerOfWhatTheyReplace) {
  put("old");
  ::chmod(path().c_str(), 0640);
  constexpr uid_t kSomebody = 12345;
  const bool may_give = ::chown(path().c_str(), kSomebody, kSomebody) == 0;  // root may
  AtomicFile file(path());
  file.commit();
  struct stat now {};
  ::stat(path().c_str(), &now);
  EXPECT_EQ(now.st_mode & 07777, 0640u);
  EXPECT_EQ(now.st_uid, may_give ? kSomebody : ::geteuid());
}

// a child that is in the middle of a file when a signal ends it
TEST_F(Files, NothingIsLeftByASignal) {
  const int fd = ::open(folder_.c_str(), O_TMPFILE | O_WRONLY, 0600);
  if (fd < 0) GTEST_SKIP() << folder_ << ": its file system has no O_TMPFILE";
  ::close(fd);
  for (const int signal : {SIGINT, SIGTERM, SIGKILL}) {
    const pid_t child = ::fork();
    if (child == 0) {
      AtomicFile file(path());
      file.write("half");
      ::raise(signal);
      ::_exit(0);
    }
    int status = 0;
    ::waitpid(child, &status, 0);
    EXPECT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == signal) << signal;
    EXPECT_TRUE(names().empty()) << signal;
  }
}

TEST_F(Files, APlantedLinkIsNotFollowed) {
  put("precious", "victim");
  // in a folder like /tmp a link that belongs to somebody else, which root alone can make
  fs::create_symlink("victim", path());
  ::chmod(folder_.c_str(), 01777);
  if (::lchown(path().c_str(), 12345, 12345) == 0) {
    EXPECT_NE(error_of([&] { AtomicFile{path()}; }).find("somebody else's link"),
              std::string::npos);
    EXPECT_EQ(get("victim"), "precious");
  }
  fs::remove(path());
  // our own stays a link
  fs::create_symlink("victim", path());
  AtomicFile file(path());
  file.write("new");
  file.commit();
  EXPECT_TRUE(fs::is_symlink(path()));
  EXPECT_EQ(get("victim"), "new");
}

TEST_F(Files, AnOutputNeverReplacesAnInput) {
  put("{}", "in");
  fs::create_hard_link(path("in"), path("alias"));
  fs::create_symlink("in", path("link"));
  EXPECT_EQ(read_json_text(path("in")), "{}");
  for (const char* name : {"in", "alias", "link"}) {
    EXPECT_NE(error_of([&] { AtomicFile{path(name)}; }).find("is read by this program"),
              std::string::npos)
        << name;
  }
  put("old", "later");
  {
    const AtomicFile begun(path("later"));
    EXPECT_NE(error_of([&] { read_whole(path("later")); }).find("is to replace it"),
              std::string::npos);
  }
  EXPECT_EQ(read_whole(path("later")), "old");
  EXPECT_EQ(get("in"), "{}");
}

TEST_F(Files, ALongNameIsAsGoodAsAShortOneAndATooLongOneIsToldAtOnce) {
  const std::string longest(255, 'x');
  AtomicFile file(path(longest));
  file.write("new");
  file.commit();
  EXPECT_EQ(get(longest), "new");
  EXPECT_NE(error_of([&] { AtomicFile{path(longest + "x")}; }).find("File name too long"),
            std::string::npos);
  EXPECT_THROW(AtomicFile{""}, std::runtime_error);
  EXPECT_THROW(AtomicFile{path("none/x")}, std::runtime_error);
}

TEST_F(Files, AnotherFileMayHaveTheNumberOfAnInputThatIsGone) {
  for (int i = 0; i < 20; ++i) {
    put("in");
    read_whole(path());
    fs::remove(path());
    put("another", "other");
    AtomicFile file(path("other"));
    file.commit();
  }
}

TEST_F(Files, JsonThatWouldEndItsParserIsRefused) {
  for (const char* bracket : {"[", "{\"a\":"}) {
    std::string deep;
    for (int i = 0; i < 100'000; ++i) deep += bracket;
    put(deep);
    EXPECT_NE(error_of([&] { read_json_text(path()); }).find("nest deeper than 64"),
              std::string::npos);
  }
  put(R"({"brackets": "[[[[\"[[", "list": [[[]]]})");
  EXPECT_EQ(read_json_text(path()), get());
  EXPECT_NE(error_of([&] { read_whole(path(), 10); }).find("longer than 10 bytes"),
            std::string::npos);
  EXPECT_NE(error_of([&] { read_whole(path("none")); }).find("No such file"), std::string::npos);
}

}  // namespace
}  // namespace tauext::test
