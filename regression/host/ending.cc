// SPDX-License-Identifier: Apache-2.0
#include "regression/host/ending.h"

#include <signal.h>
#include <sys/wait.h>

#include <filesystem>
#include <mutex>
#include <set>
#include <thread>

namespace tauext::gate {
namespace {

struct Listed {
  std::mutex mutex;
  std::set<pid_t> children;
  std::set<std::string> folders;
};

// never destroyed: the thread that waits for signals may need it to the last
Listed& listed() {
  static Listed& all = *new Listed;
  return all;
}

void end(int signal) {
  const std::lock_guard lock(listed().mutex);  // nothing is begun any more
  for (const pid_t child : listed().children) ::kill(child, SIGTERM);
  for (const pid_t child : listed().children) ::waitpid(child, nullptr, 0);
  std::error_code ignored;
  for (const std::string& folder : listed().folders) std::filesystem::remove_all(folder, ignored);
  // as it would have ended without us
  sigset_t only;
  sigemptyset(&only);
  sigaddset(&only, signal);
  pthread_sigmask(SIG_UNBLOCK, &only, nullptr);
  ::raise(signal);
}

}  // namespace

void end_with_children_and_folders() {
  sigset_t signals;
  sigemptyset(&signals);
  for (const int s : {SIGINT, SIGTERM, SIGHUP}) {
    struct sigaction action {};
    // nohup's wish stays
    if (::sigaction(s, nullptr, &action) == 0 && action.sa_handler != SIG_IGN) {
      sigaddset(&signals, s);
    }
  }
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  std::thread([signals] {
    int signal = 0;
    if (::sigwait(&signals, &signal) == 0) end(signal);
  }).detach();
}

ListedChild::ListedChild(pid_t pid) : pid_(pid) {
  const std::lock_guard lock(listed().mutex);
  listed().children.insert(pid_);
}

ListedChild::~ListedChild() {
  const std::lock_guard lock(listed().mutex);
  listed().children.erase(pid_);
}

void list_folder(const std::string& path) {
  const std::lock_guard lock(listed().mutex);
  listed().folders.insert(path);
}

void unlist_folder(const std::string& path) {
  const std::lock_guard lock(listed().mutex);
  listed().folders.erase(path);
}

}  // namespace tauext::gate
