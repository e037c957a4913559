// SPDX-License-Identifier: Apache-2.0
#include "regression/host/child.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <stdexcept>

#include "regression/host/ending.h"

extern char** environ;

namespace tauext::gate {
namespace {

// starts it with its standard output on that end of a pipe; 0 or why it could not be started
int spawn(const std::vector<std::string>& argv, const int (&ends)[2], pid_t& pid) {
  posix_spawn_file_actions_t actions;
  ::posix_spawn_file_actions_init(&actions);
  ::posix_spawn_file_actions_adddup2(&actions, ends[1], STDOUT_FILENO);
  ::posix_spawn_file_actions_addclose(&actions, ends[0]);
  ::posix_spawn_file_actions_addclose(&actions, ends[1]);
  // what this program waits for its child does not
  posix_spawnattr_t attributes;
  ::posix_spawnattr_init(&attributes);
  sigset_t none;
  sigemptyset(&none);
  ::posix_spawnattr_setsigmask(&attributes, &none);
  ::posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK);
  std::vector<char*> args;
  for (const std::string& a : argv) args.push_back(const_cast<char*>(a.c_str()));
  args.push_back(nullptr);
  const int error = ::posix_spawnp(&pid, args[0], &actions, &attributes, args.data(), environ);
  ::posix_spawnattr_destroy(&attributes);
  ::posix_spawn_file_actions_destroy(&actions);
  return error;
}

std::string read_to_the_end(int stream) {
  std::string all;
  std::array<char, 65536> buffer;
  for (ssize_t n; (n = ::read(stream, buffer.data(), buffer.size())) != 0;) {
    if (n > 0)
      all.append(buffer.data(), static_cast<std::size_t>(n));
    else if (errno != EINTR)
      break;
  }
  return all;
}

}  // namespace

std::string this_program() {
  return std::filesystem::read_symlink("/proc/self/exe").string();
}

Finished finish_child(const std::vector<std::string>& argv) {
  int ends[2];
  if (::pipe2(ends, O_CLOEXEC) != 0)
    throw std::runtime_error(fmt::format("pipe: {}", std::strerror(errno)));
  pid_t pid = 0;
  const int error = spawn(argv, ends, pid);
  ::close(ends[1]);
  if (error != 0) {
    ::close(ends[0]);
    return {127, std::strerror(error)};
  }
  const ListedChild child(pid);
  Finished f{0, read_to_the_end(ends[0])};
  ::close(ends[0]);
  int status = 0;
  while (::waitpid(pid, &status, 0) < 0) {
    if (errno != EINTR)
      throw std::runtime_error(fmt::format("{}: {}", argv[0], std::strerror(errno)));
  }
  f.code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  return f;
}

std::string processor() {
  std::ifstream in("/proc/cpuinfo");
  for (std::string line; std::getline(in, line);) {
    if (line.starts_with("model name")) return line.substr(line.find(": ") + 2);
  }
  return "unknown processor";
}

std::string run_child(const std::vector<std::string>& argv) {
  Finished f = finish_child(argv);
  if (f.code == 127)
    throw std::runtime_error(fmt::format("{}: cannot be run: {}", argv[0], f.output));
  if (f.code != 0)
    throw std::runtime_error(fmt::format("{}: failed with exit code {}", argv[0], f.code));
  return std::move(f.output);
}

}  // namespace tauext::gate
