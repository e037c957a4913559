// SPDX-License-Identifier: Apache-2.0
// Messages and logs as nobody should send them: nothing crashes (the sanitizers look), nothing is
// half-taken.
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <random>

#include "lcmtypes/log.h"
#include "lcmtypes/test/samples.h"

namespace tauext::test {
namespace {

namespace fs = std::filesystem;
using Message = std::vector<std::byte>;

class Mutator {
 public:
  std::size_t below(std::size_t n) { return static_cast<std::size_t>(generator_() % n); }

  Message operator()(Message m) {
    const std::size_t kinds = 1 + below(3);
    for (std::size_t i = 0; i < kinds; ++i) mutate(m);
    return m;
  }

 private:
  void mutate(Message& m) {
    const std::size_t kind = below(6);
    if (kind == 0) {  // truncated
      m.resize(below(m.size() + 1));
    } else if (kind == 1) {  // longer
      for (std::size_t n = 1 + below(64); n > 0; --n) m.push_back(any());
    } else if (m.size() < 8) {
      m.push_back(any());
    } else if (kind == 2) {  // a forged count or length: four bytes of an extreme
      constexpr std::uint32_t kExtremes[] = {0,     1,          8,          9,         255,
                                             65536, 0x7fffffff, 0x80000000, 0xffffffff};
      const std::uint32_t value = kExtremes[below(std::size(kExtremes))];
      const std::size_t at = below(m.size() - 3);
      for (int b = 0; b < 4; ++b) m[at + b] = static_cast<std::byte>(value >> (24 - 8 * b));
    } else if (kind == 3) {  // a wrong hash
      m[below(8)] ^= static_cast<std::byte>(1 + below(255));
    } else {
      m[below(m.size())] = any();
    }
  }
  std::byte any() { return static_cast<std::byte>(below(256)); }

  std::mt19937_64 generator_{1};
};

std::vector<Message> originals() {
  return {write(reading(1), MessageType::kTauext),
          write(reading(1), MessageType::kIiwa),
          write(reading(1, 7), MessageType::kPanda),
          bytes_of(estimate()),
          bytes_of(detection()),
          bytes_of(summary())};
}

// whether a message of any type is in range, once it was accepted
template <class T>
bool accepted(const Message& m) {
  T out{};
  if (decode(m, out) != Reject::kNone) return false;
  // what was accepted is whole: it encodes to the bytes it came from
  EXPECT_TRUE(bytes_of(out) == m);
  return true;
}

TEST(Fuzz, TenThousandMutatedMessagesAreAcceptedWholeOrRejected) {
  Mutator mutate;
  const std::vector<Message> all = originals();
  int good = 0, bad = 0;
  for (int i = 0; i < 10000; ++i) {
    const Message m = mutate(all[i % all.size()]);
    const int types = accepted<sample_t>(m) + accepted<estimate_t>(m) + accepted<detection_t>(m) +
                      accepted<summary_t>(m) + accepted<iiwa_status_t>(m) +
                      accepted<panda_status_t>(m);
    EXPECT_LE(types, 1);
    ++(types == 1 ? good : bad);
    MessageType type{};
    Reading r;
    if (type_of(m, type) == Reject::kNone && read(m, type, r) == Reject::kNone) {
      EXPECT_TRUE(r.n >= 1 && r.n <= kMaxJoints);
    }
  }
  EXPECT_GT(bad, 5000);  // and not all of them, or the mutants would be too easy
  EXPECT_GT(good, 500);
}

TEST(Fuzz, MutatedLogsAreReadToTheirEnd) {
  const fs::path path =
      fs::temp_directory_path() / ("tauext_fuzz_" + std::to_string(::getpid()) + ".lcm");
  LogBuffer log;
  const std::vector<Message> all = originals();
  for (int k = 0; k < 60; ++k) log.append("TAUEXT_TEST", k, all[k % all.size()]);
  const auto* const begin = reinterpret_cast<const std::byte*>(log.bytes().data());
  const Message whole(begin, begin + log.bytes().size());
  Mutator mutate;
  int events = 0;
  for (int i = 0; i < 1000; ++i) {
    const Message m = mutate(mutate(whole));
    std::ofstream(path, std::ios::binary)
        .write(reinterpret_cast<const char*>(m.data()), static_cast<std::streamsize>(m.size()));
    std::size_t seen = 0;
    try {
      const LogFaults faults = read_log(path.string(), [&](const LogEvent& e) {
        seen += 28 + e.channel.size() + e.message.size();
        ++events;
      });
      EXPECT_LE(seen + static_cast<std::size_t>(faults.junk_bytes), m.size());
      EXPECT_TRUE(seen + static_cast<std::size_t>(faults.junk_bytes) == m.size() ||
                  faults.truncated);
    } catch (const std::runtime_error&) {
      EXPECT_EQ(seen, 0u);  // no event in it
    }
  }
  fs::remove(path);
  EXPECT_GT(events, 20000);
}

}  // namespace
}  // namespace tauext::test
