// SPDX-License-Identifier: Apache-2.0
#include "bench/entry_tap.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <stdexcept>
#include <utility>

#include "bench/lcm_trace.h"
#include "lcmtypes/emitter.h"
#include "lcmtypes/transport.h"
#include "mjcf/atomic_file.h"

namespace tauext {

struct EntryTap::Outlet {
  explicit Outlet(const std::string& url) : transport(url) {}
  Transport transport;
  bool told = false;
  int published = 0;
};

EntryTap::EntryTap(const std::optional<std::string>& url, std::string folder)
    : folder_(std::move(folder)) {
  if (!folder_.empty()) {
    std::error_code error;
    std::filesystem::create_directories(folder_, error);
    if (!std::filesystem::is_directory(folder_)) {
      throw std::runtime_error(
          fmt::format("--lcm-log {}: cannot make this folder: {}", folder_, error.message()));
    }
  }
  if (!url) return;
  outlet_ = std::make_unique<Outlet>(*url);
  if (outlet_->transport.good()) return;
  fmt::print(stderr, "streaming is off: {}\n", outlet_->transport.trouble());
  outlet_->told = true;
}

EntryTap::~EntryTap() = default;

void EntryTap::log(const Entry& entry, const Suite::Run& run, const Score& score) const {
  std::string name = entry.name() + ".lcm";
  std::replace(name.begin(), name.end(), '/', '_');
  LogBuffer log;
  append_entry(entry, run.trace, run.output, run.detections, score, log);
  AtomicFile file((std::filesystem::path(folder_) / name).string());
  file.write(log.bytes());
  file.commit();
}

void EntryTap::publish(const Entry& entry, const Score& score) {
  if (!outlet_) return;
  summary_t m = summary_of(entry, score);
  m.program = "tauext-bench " TAUEXT_VERSION;
  m.utime = std::chrono::duration_cast<std::chrono::microseconds>(
                std::chrono::system_clock::now().time_since_epoch())
                .count();
  std::vector<std::byte> bytes(m.getEncodedSize());
  const std::size_t size = encode(m, bytes);
  if (outlet_->transport.publish(kSummaryChannel, {bytes.data(), size})) {
    ++outlet_->published;
    return;
  }
  if (std::exchange(outlet_->told, true)) return;
  fmt::print(stderr, "\nsummaries to {} fail; the run goes on\n", outlet_->transport.url());
}

bool EntryTap::heard() const {
  return !outlet_ || outlet_->published > 0;
}

}  // namespace tauext
