// SPDX-License-Identifier: Apache-2.0
// libFuzzer's targets: all that reads what comes from outside. Each tries one reader with any
// bytes, and looks at what it makes of them.
//     tauext_fuzz --target=NAME [CORPUS...] [libFuzzer's flags]
#include <fmt/format.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <fstream>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "bench/live/stream_table.h"
#include "bench/logs/contacts_file.h"
#include "bench/logs/lcm_reader.h"
#include "bench/roster/threshold_file.h"
#include "bench/score/degradation.h"
#include "lcmtypes/receive/arrivals.h"
#include "lcmtypes/wire.h"
#include "mjcf/mujoco/layout.h"
#include "mjcf/plant/model.h"
#include "mjcf/trace/read/bag/bag_rows.h"
#include "mjcf/trace/read/column_map_file.h"
#include "mjcf/trace/read/recording.h"
#include "regression/accuracy/golden_file.h"
#include "regression/counts/counts.h"

namespace tauext {

namespace {

// for libFuzzer a finding
void demand(bool holds, const char* what) {
  if (holds) return;
  std::fprintf(stderr, "not so: %s\n", what);
  std::abort();
}

// the input as a file, always the same one
std::string file_of(Bytes input) {
  static const int descriptor = ::memfd_create("input", MFD_CLOEXEC);
  demand(::ftruncate(descriptor, 0) == 0 && ::pwrite(descriptor, input.data(), input.size(), 0) ==
                                                static_cast<ssize_t>(input.size()),
         "the input can be written");
  return fmt::format("/proc/self/fd/{}", descriptor);
}

// what users get is an error in one line that names the file
void refused_or(const std::string& path, const std::function<void()>& read) {
  try {
    read();
  } catch (const std::runtime_error& e) {
    const std::string_view what = e.what();
    demand(what.starts_with(path + ": "), "an error names the file");
    demand(what.find('\n') == what.npos, "an error is one line");
    demand(what.size() < 2000, "an error can be read");
  }
}

// messages may hold numbers that are none, which estimators flag
void demand_trace(const Trace& t, bool finite) {
  demand(t.size() > 0 && t.dof() > 0, "a trace has samples");
  for (const Eigen::MatrixXd* m : {&t.q, &t.qd, &t.tau}) {
    demand(m->rows() == t.dof() && m->cols() == t.size(), "a trace has numbers of each joint");
    demand(!finite || m->allFinite(), "numbers are finite");
  }
  for (int k = 0; k < t.size(); ++k) {
    demand(std::isfinite(t.t[k]) && (k == 0 || t.t[k] > t.t[k - 1]), "time goes on");
  }
}

// CSV, .npy, .npz, .mat or a bag, as it begins
void recording(Bytes input) {
  const std::string path = file_of(input);
  refused_or(path, [&] {
    SkippedRows skipped;
    demand_trace(read_recording(path, {}, &skipped), true);
    demand(static_cast<int>(skipped.first.size()) <= skipped.total(), "what is named is counted");
  });
}

// the same, with rows that have a part of a sample each
void joined(Bytes input) {
  struct Map {
    const std::string path = (std::filesystem::temp_directory_path() /
                              fmt::format("tauext_fuzz_{}.toml", static_cast<long>(::getpid())))
                                 .string();
    Map() { std::ofstream(path) << "preset = 'tauext'\njoin = 0.05\n"; }
    ~Map() { std::filesystem::remove(path); }
  };
  static const Map map;
  const std::string path = file_of(input);
  refused_or(path, [&] {
    SkippedRows skipped;
    demand_trace(read_recording(path, {map.path, "", {}}, &skipped), true);
  });
}

void contacts(Bytes input) {
  const std::string path = file_of(input);
  try {
    const ContactsFile file(path, {"a.csv", "b.csv"});
    for (const char* log : {"a.csv", "b.csv"}) {
      double last = -std::numeric_limits<double>::infinity();
      for (const LabelledContact& c : file.of(log)) {
        demand(c.from <= c.to && c.from >= last, "contacts are in order, and apart");
        last = c.to;
      }
    }
  } catch (const std::invalid_argument& e) {
    const std::string_view what = e.what();
    demand(what.starts_with(path + ": "), "an error names the file");
    demand(what.find('\n') == what.npos && what.size() < 2000, "an error is a line");
  }
}

// a topic of any type, too
void bag(Bytes input) {
  recording(input);
  const std::string path = file_of(input);
  refused_or(path, [&] {
    BagRows rows(path, "/a");
    SkippedRows skipped;
    for (std::vector<double> row; rows.next(row, skipped);)
      demand(row.size() == rows.columns().size(), "a row has a number for each column");
  });
}

void map(Bytes input) {
  const std::string_view text{reinterpret_cast<const char*>(input.data()), input.size()};
  try {
    column_map_of(text, "map.toml").mapped({"t", "q1", "q2"}, "log.csv");
  } catch (const std::exception& e) {
    const std::string_view what = e.what();
    demand(what.starts_with("map.toml: ") || what.starts_with("log.csv: "),
           "an error names the file");
    demand(what.find('\n') == what.npos, "an error is one line");
  }
}

// every byte is of an event or junk, but for an event that is cut off
void events_of_log(const std::string& path, std::size_t size) {
  std::size_t seen = 0;
  const LogFaults faults = read_log(path, [&](const LogEvent& e) {
    constexpr std::size_t kHead = 28;
    seen += kHead + e.channel.size() + e.message.size();
  });
  seen += static_cast<std::size_t>(faults.junk_bytes);
  demand(seen == size || (faults.truncated && seen < size), "every byte of a log is accounted for");
}

void log(Bytes input) {
  const std::string path = file_of(input);
  refused_or(path, [&] { events_of_log(path, input.size()); });
  refused_or(path, [&] {
    LcmReader reader(path, "");
    demand_trace(trace_of(reader), false);
    const LogReport report = reader.report();
    demand(report.rejected >= 0 && report.out_of_order >= 0 && report.lost >= 0, "counts count");
  });
}

// whether it is a good message of that type, which then is whole
template <class Message>
bool is_good(Bytes input) {
  Message m{};
  if (decode(input, m) != Reject::kNone) return false;
  std::string again(input.size(), '\0');
  demand(encode(m, std::as_writable_bytes(std::span(again))) == input.size() &&
             std::equal(input.begin(), input.end(), std::as_bytes(std::span(again)).begin()),
         "what was decoded encodes to the same bytes");
  return true;
}

void wire(Bytes input) {
  stamp_of(input);
  MessageType type{};
  Reading r;
  if (type_of(input, type) == Reject::kNone && read(input, type, r) == Reject::kNone) {
    demand(r.n >= 1 && r.n <= kMaxJoints && r.utime >= 0, "a reading is in range");
  }
  demand(is_good<sample_t>(input) + is_good<estimate_t>(input) + is_good<detection_t>(input) +
                 is_good<force_t>(input) + is_good<summary_t>(input) +
                 is_good<iiwa_status_t>(input) + is_good<panda_status_t>(input) <=
             1,
         "a message is of one type");
}

void demand_account(const Account& a) {
  demand(a.used >= 0 && a.late >= 0 && a.repeated >= 0 && a.rejected >= 0 && a.lost >= 0,
         "an account has no debts");
}

void demand_printable(std::string_view text) {
  for (const unsigned char c : text) {
    demand(c == '\n' || (c >= ' ' && c != 0x7f), "there are no control bytes");
  }
}

// what came from the network, again and again: the sender, the length in two bytes, the datagram
void datagrams(Bytes input) {
  live::StreamTable table;
  Arrivals arrivals;
  std::int64_t now = 0, taken = 0;
  while (input.size() >= 3) {
    const auto at = [&](std::size_t i) { return std::to_integer<std::size_t>(input[i]); };
    const Sender sender = at(0) % 4;
    const std::size_t length = std::min(at(1) | at(2) << 8, input.size() - 3);
    // of exactly its size, so that the sanitizer sees its end
    const std::vector<std::byte> datagram(input.begin() + 3,
                                          input.begin() + 3 + static_cast<std::ptrdiff_t>(length));
    now += 1000 * static_cast<std::int64_t>(at(0) / 4);
    input = input.subspan(3 + length);
    Datagram d;
    if (parse(datagram, d) != Refusal::kNone) continue;
    demand(!d.channel.empty() && d.channel.size() <= kLongestChannel, "a channel has a name");
    demand(d.channel.size() + d.message.size() + 9 == datagram.size(), "its parts are all of it");
    table.take(d.channel, sender, now, d.message);
    ++taken;
    MessageType type{};
    Reading reading;
    if (type_of(d.message, type) == Reject::kNone &&
        read(d.message, type, reading) == Reject::kNone) {
      arrivals.take(reading, sender, now);
    } else {
      arrivals.reject(stamp_of(d.message), sender);
    }
  }
  demand_account(arrivals.counts());
  demand_account(table.account());
  const Account a = table.account();
  demand(a.sent() - a.lost <= taken, "nothing is counted twice");
  demand_printable(table.format(now));
  demand_printable(table.totals({}));
  for (const std::string& e : table.events()) demand_printable(e);
}

void json(Bytes input) {
  const std::string path = file_of(input);
  refused_or(path, [&] {
    Degradation d;
    read_degradation(path, d);
    describe(d);
  });
  refused_or(path, [&] {
    const Thresholds t = read_thresholds(path);
    demand(t.margin > 0 && !t.sets.empty(), "thresholds can be used");
  });
}

void baseline(Bytes input) {
  const std::string path = file_of(input);
  refused_or(path, [&] { gate::read_golden(path); });
  refused_or(path, [&] { gate::read_counts(path); });
}

// what the child hands back is used in this process
void mjcf(Bytes input) {
  const std::string path = file_of(input);
  refused_or(path, [&] {
    try {
      const Model m = load_mjcf(path);
      const State d = initial_state(*m);
      try {
        demand(layout_of(*m, *d).dof > 0, "an arm has joints");
      } catch (const std::invalid_argument&) {  // it is no arm
      }
    } catch (const std::runtime_error& e) {
      // an input's own words stand elsewhere in a message
      const std::string_view what = e.what();
      const bool of_child = what.starts_with(path + ": MuJoCo ");
      for (const char* finding : {"ends without", "File size", "Aborted"}) {
        demand(!of_child || what.find(finding) == what.npos,
               "the child's sanitizers have found nothing");
      }
      throw;
    }
  });
}

const std::map<std::string_view, void (*)(Bytes)> kTargets{
    {"csv", recording}, {"npy", recording},       {"bag", bag},           {"mat", recording},
    {"map", map},       {"joined", joined},       {"contacts", contacts}, {"log", log},
    {"wire", wire},     {"datagrams", datagrams}, {"json", json},         {"baseline", baseline},
    {"mjcf", mjcf}};

void (*target)(Bytes) = nullptr;

// of --target=NAME, which libFuzzer leaves to us
void choose(int argc, char** argv) {
  constexpr std::string_view kFlag = "--target=";
  for (int i = 1; i < argc; ++i) {
    const std::string_view argument = argv[i];
    if (!argument.starts_with(kFlag)) continue;
    const auto it = kTargets.find(argument.substr(kFlag.size()));
    if (it != kTargets.end()) target = it->second;
  }
  if (target != nullptr) return;
  std::fputs("tauext_fuzz: --target=NAME is wanted; known:", stderr);
  for (const auto& [name, function] : kTargets) std::fprintf(stderr, " %s", name.data());
  std::fputs("\n", stderr);
  std::exit(2);
}

}  // namespace
}  // namespace tauext

// MuJoCo asks for what it cannot have, and handles that
extern "C" const char* __asan_default_options() {
  return "allocator_may_return_null=1";
}

extern "C" int LLVMFuzzerInitialize(int* argc, char*** argv) {
  tauext::choose(*argc, *argv);
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  tauext::target(std::as_bytes(std::span(data, size)));
  return 0;
}
