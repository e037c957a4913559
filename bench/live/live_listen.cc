// SPDX-License-Identifier: Apache-2.0
#include "bench/live/live_listen.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include <cstdio>
#include <stdexcept>
#include <utility>

#include "bench/live/interrupt.h"
#include "bench/live/stream_table.h"
#include "bench/program/program.h"
#include "lcmtypes/listener.h"
#include "mjcf/trace/printable.h"

namespace tauext::live {
namespace {

// what is heard, on standard output: a table on a terminal, else events as they come and a table at
// the end
class Screen {
 public:
  explicit Screen(const Listener& listener) : listener_(listener) {}

  void show(StreamTable& table, double seconds, std::int64_t now) {
    take_events(table);
    if (!terminal_ || seconds - shown_ < kEvery) return;
    shown_ = seconds;
    fmt::print("\033[H\033[2J{}  {:.0f} s\n\n{}\n{}\n{}\n", listener_.url(), seconds,
               table.format(now), table.totals(listener_.refused()), fmt::join(events_, "\n"));
    std::fflush(stdout);
  }
  void close(StreamTable& table, std::int64_t now) {
    take_events(table);
    fmt::print("{}{}", terminal_ ? "\n" : table.format(now), table.totals(listener_.refused()));
  }

 private:
  static constexpr double kEvery = 0.2;  // [s]

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
  bool terminal_ = is_terminal(STDOUT_FILENO);
  double shown_ = 0;  // [s]
  std::vector<std::string> events_;
};

}  // namespace

int run_listen(const Options& o) {
  const auto begin = std::chrono::steady_clock::now();
  const auto now = [&] { return microseconds_since(begin); };
  StreamTable table;
  Listener listener(o.url, {"TAUEXT_*"}, [&](std::string_view channel, Sender sender, Bytes m) {
    table.take(channel, sender, now(), m);
  });
  const Interrupt interrupt;
  say(fmt::format("listening to TAUEXT_* at {}; Ctrl-C ends", listener.url()));
  Screen screen(listener);
  bool ended = false, broken = false, at_end = false;
  while (!broken && !ended) {
    ended = over(interrupt, begin, o.pace.duration);
    try {
      listener.wait(50);  // what has come by then is taken
    } catch (const std::runtime_error& e) {
      broken = true;
      at_end = listener.url().starts_with("file://");  // a log is over
      if (!at_end) say(e.what());
    }
    screen.show(table, seconds_since(begin), now());
  }
  screen.close(table, now());
  return table.account().used > 0 && (!broken || at_end) ? kGood : kAnswerIsNo;
}

}  // namespace tauext::live
