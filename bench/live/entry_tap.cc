// SPDX-License-Identifier: Apache-2.0
#include "bench/live/entry_tap.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <stdexcept>
#include <utility>

#include "bench/logs/lcm_trace.h"
#include "lcmtypes/emitter.h"
#include "lcmtypes/transport.h"
#include "mjcf/trace/atomic_file.h"
#include "mjcf/trace/printable.h"

namespace tauext {
namespace {

void append(const char* channel, const summary_t& m, LogBuffer& log) {
  std::vector<std::byte> bytes(m.getEncodedSize());
  const std::size_t size = encode(m, bytes);
  log.append(channel, m.utime, {bytes.data(), size});
}

}  // namespace

summary_t summary_of(const Entry& entry, const Score& score) {
  summary_t m{};
  m.entry = entry.name();
  m.error = score.error;
  m.rmse_Nm = score.get(Metric::kRmse).value_or(-1);
  m.step_ns = score.get(Metric::kCpu).value_or(-1);
  for (const auto& [key, value] : score.by_key()) {
    if (!std::isfinite(value)) continue;
    m.key.push_back(key);
    m.value.push_back(value);
  }
  m.n = static_cast<std::int32_t>(m.key.size());
  return m;
}

void append_entry(const Entry& entry, const Trace& trace, const Output& output,
                  const std::vector<Detection>& detections, const Score& score, LogBuffer& log) {
  Emitter emitter({{entry.estimator(), entry.detector()}}, 0,
                  [&](const char* channel, std::int64_t utime, Bytes message) {
                    log.append(channel, utime, message);
                    return true;
                  });
  const std::vector<Reading> readings = readings_of(trace);
  for (int k = 0; k < trace.size(); ++k) {
    const Reading& r = readings[k];
    log.append(kSampleChannel, r.utime, write(r, MessageType::kTauext));
    LiveSample s;
    s.reading = r;
    Eigen::VectorXd::Map(s.tau_ext_hat.data(), r.n) = output.tau_ext.col(k);
    s.status = static_cast<std::int8_t>(output.status[k]);
    if (!detections.empty()) {
      s.mark = detections[k].mark;
      s.score = detections[k].score;
      s.contact = static_cast<std::int8_t>(detections[k].contact);
    }
    emitter.add(s);
  }
  summary_t summary = summary_of(entry, score);
  summary.utime = trace.size() > 0 ? readings.back().utime : 0;
  summary.samples = trace.size();
  summary.published = emitter.counts().sent;
  append(kSummaryChannel, summary, log);
}

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
  refuse_input_as_log(lcm_url(*url));
  outlet_ = std::make_unique<Outlet>(*url);
  if (outlet_->transport.good()) return;
  say("streaming is off: " + outlet_->transport.trouble());
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
  say(fmt::format("summaries to {} fail; the run goes on", outlet_->transport.url()));
}

bool EntryTap::heard() const {
  return !outlet_ || outlet_->published > 0;
}

}  // namespace tauext
