// SPDX-License-Identifier: Apache-2.0
#include "bench/live/live_listen.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdio>
#include <sstream>
#include <stdexcept>
#include <string>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

#include "bench/live/interrupt.h"
#include "bench/live/stream_table.h"
#include "bench/live/view/viewers.h"
#include "bench/program/program.h"
#include "lcmtypes/listener.h"
#include "lcmtypes/log.h"
#include "mjcf/trace/printable.h"

namespace tauext::live {
namespace {

// keys as they are pressed, while this is there; none unless both ends are a terminal, and ours
class Keys {
 public:
  Keys() {
    if (!on_ || ::tcgetattr(STDIN_FILENO, &before_) != 0) return;
    termios now = before_;
    now.c_lflag &= ~static_cast<tcflag_t>(ICANON | ECHO);
    now.c_cc[VMIN] = 0, now.c_cc[VTIME] = 0;  // a read does not wait
    changed_ = ::tcsetattr(STDIN_FILENO, TCSANOW, &now) == 0;
  }
  ~Keys() {
    if (changed_) ::tcsetattr(STDIN_FILENO, TCSANOW, &before_);
  }
  Keys(const Keys&) = delete;
  Keys& operator=(const Keys&) = delete;

  // 0 if there is none
  char next() const {
    char key = 0;
    return changed_ && ::read(STDIN_FILENO, &key, 1) == 1 ? key : '\0';
  }

 private:
  bool on_ = is_terminal(STDIN_FILENO) && is_terminal(STDOUT_FILENO) &&
             ::tcgetpgrp(STDIN_FILENO) == ::getpgrp();
  bool changed_ = false;
  termios before_{};
};

// what is heard, on standard output: a table on a terminal, as much of it as fits, else events as
// they come and a table at the end
class Screen {
 public:
  // @param from where messages come from, and who looks at them beside
  Screen(const Listener& listener, std::string from)
      : listener_(listener), from_(std::move(from)) {}

  void show(StreamTable& table, double seconds, std::int64_t now) {
    take_events(table);
    bool pressed = false;
    while (const char key = keys_.next()) {
      if (key >= '0' && key <= '0' + table.joints()) joint_ = key - '0', pressed = true;
    }
    if (terminal_ && (pressed || seconds - shown_ >= kEvery)) draw(table, seconds, now);
  }
  void close(StreamTable& table, double seconds, std::int64_t now) {
    take_events(table);
    if (terminal_) return draw(table, seconds, now);
    fmt::print("{}{}", table.format(now), table.totals(listener_.refused()));
  }

 private:
  static constexpr double kEvery = 0.2;  // [s]
  using Lines = std::vector<std::string>;

  void draw(const StreamTable& table, double seconds, std::int64_t now) {
    shown_ = seconds;
    fmt::print("\033[H\033[2J{}", text(table, seconds, now));
    std::fflush(stdout);
  }

  static Lines lines_of(const std::string& text) {
    Lines all;
    std::istringstream in(text);
    for (std::string line; std::getline(in, line);) all.push_back(line);
    return all;
  }

  // in lines of so many columns, broken between words
  static std::string wrapped(const std::string& text, std::size_t columns) {
    std::string out;
    for (std::string line : lines_of(text)) {
      while (line.size() > columns) {
        const std::size_t blank = line.rfind(' ', columns);
        if (blank == line.npos || blank < 3)
          break;  // a word that long, and what follows it, is cut
        out += line.substr(0, blank) + "\n";
        line.replace(0, blank, " ");
      }
      out += line + "\n";
    }
    return out;
  }

  std::string text(const StreamTable& table, double seconds, std::int64_t now) const {
    winsize size{};
    const bool known = ::ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_row > 0;
    const std::size_t rows = known ? size.ws_row - 1 : 1000, columns = known ? size.ws_col : 1000;
    std::string below;
    const std::string end = wrapped(table.totals(listener_.refused()), columns);
    std::string body = table.format(now);
    const auto fits = [&](const std::string& t) {
      const Lines all = lines_of(t);
      return all.size() + lines_of(end).size() + 4 <= rows &&
             std::all_of(all.begin(), all.end(), [&](auto& l) { return l.size() <= columns; });
    };
    if (!fits(body)) {
      body = table.format_small(now, joint_);
      below = joint_ == 0 ? fmt::format("joints with the largest torque; keys 1 to {}: that joint",
                                        table.joints())
                          : fmt::format("joint {}; key 0: those with the largest torque", joint_);
      if (const std::string forces = table.format_forces(now, true); !forces.empty()) {
        if (fits(body + "\n" + forces))
          body += "\n" + forces;
        else
          below += "; forces need more rows";
      }
    }
    Lines all =
        lines_of(fmt::format("{}  {:.0f} s\n{}\n{}\n{}\n", from_, seconds, below, body, end));
    const std::size_t room = rows > all.size() ? rows - all.size() : 0;
    all.insert(all.end(), events_.end() - std::min<std::ptrdiff_t>(room, events_.size()),
               events_.end());
    if (all.size() > rows) all.resize(rows);
    for (std::string& line : all) line.resize(std::min(line.size(), columns));
    return fmt::format("{}\n", fmt::join(all, "\n"));
  }

  void take_events(StreamTable& table) {
    constexpr std::size_t kShown = 12;
    for (std::string& line : table.events()) {
      if (!terminal_) fmt::print("{}\n", line);
      events_.push_back(std::move(line));
    }
    if (!terminal_) std::fflush(stdout);
    if (events_.size() > kShown) events_.erase(events_.begin(), events_.end() - kShown);
  }

  const Listener& listener_;
  std::string from_;
  bool terminal_ = is_terminal(STDOUT_FILENO);
  Keys keys_;
  int joint_ = 0;     // from 1; 0: that with the largest torque
  double shown_ = 0;  // [s]
  Lines events_;
};

// what LCM does not say: its reader stops where bytes are none of a message
void say_faults(const std::string& log) {
  const LogFaults faults = read_log(log, [](const LogEvent&) {});
  if (faults.junk_stretches > (faults.truncated ? 1 : 0))
    say(
        fmt::format("{}: {} bytes belong to no message; what follows the first of them was not "
                    "shown; tauext-replay passes over them",
                    log, faults.junk_bytes));
  if (faults.truncated) say(log + ": its last message is cut off");
}

}  // namespace

int run_listen(const Options& o) {
  const Interrupt interrupt;
  auto begin = std::chrono::steady_clock::now();
  const auto now = [&] { return microseconds_since(begin); };
  StreamTable table;
  const std::string url = lcm_url(o.url), log = log_of(url);
  if (LogEvent first; !log.empty()) LogEvents(log).next(first);  // what is no log is refused
  Viewers viewers(o.page, o.plotjuggler, url);
  if (!log.empty() && viewers.page_is_unseen()) {
    say(url + viewers.where() + "; the log begins when a browser shows it; Ctrl-C ends");
    while (viewers.page_is_unseen() && !over(interrupt, begin, o.pace.duration))
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
    begin = std::chrono::steady_clock::now();
  }
  Listener listener(url, {"TAUEXT_*"}, [&](std::string_view channel, Sender sender, Bytes m) {
    if (table.take(channel, sender, now(), m)) viewers.take(channel, m);
  });
  say(fmt::format("listening to TAUEXT_* at {}{}; Ctrl-C ends", listener.url(), viewers.where()));
  Screen screen(listener, listener.url() + viewers.where());
  bool ended = false, at_end = false;
  std::string broken;  // why
  while (broken.empty() && !ended) {
    ended = over(interrupt, begin, o.pace.duration);
    try {
      listener.wait(50);  // what has come by then is taken
    } catch (const std::runtime_error& e) {
      broken = e.what();
      at_end = !log.empty();  // it is over
    }
    screen.show(table, seconds_since(begin), now());
  }
  screen.close(table, seconds_since(begin), now());
  if (at_end) say_faults(log);
  if (!broken.empty() && !at_end) say(broken);
  return table.account().used > 0 && (broken.empty() || at_end) ? kGood : kAnswerIsNo;
}

}  // namespace tauext::live
