// SPDX-License-Identifier: Apache-2.0
#include "bench/logs/lcm_trace.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <stdexcept>
#include <string_view>

#include "lcmtypes/emitter.h"
#include "lcmtypes/lcm_url.h"
#include "mjcf/trace/input_file.h"

namespace tauext {
namespace {

const char* channel_of(MessageType type) {
  switch (type) {
    case MessageType::kIiwa:
      return "IIWA_STATUS";
    case MessageType::kPanda:
      return "PANDA_STATUS";
    case MessageType::kTauext:
      break;
  }
  return kSampleChannel;
}

}  // namespace

std::int64_t utime_of(double t) {
  return std::llround(t * 1e6);
}

std::vector<Reading> readings_of(const Trace& trace) {
  const int n = trace.dof();
  if (n > kMaxJoints) {
    throw std::invalid_argument(fmt::format("{} joints: a message holds {}", n, kMaxJoints));
  }
  const double origin = trace.size() > 0 ? std::min(trace.t[0], 0.0) : 0;
  std::vector<Reading> all(trace.size());
  for (int k = 0; k < trace.size(); ++k) {
    Reading& r = all[k];
    r.seq = k;
    r.t = trace.t[k] - origin;
    r.utime = utime_of(r.t);
    r.n = n;
    Eigen::VectorXd::Map(r.q.data(), n) = trace.q.col(k);
    Eigen::VectorXd::Map(r.qd.data(), n) = trace.qd.col(k);
    Eigen::VectorXd::Map(r.tau.data(), n) = trace.tau.col(k);
    if (trace.has_truth()) {
      r.reference = ReferenceKind::kTruth;
      Eigen::VectorXd::Map(r.tau_ext.data(), n) = trace.tau_ext.col(k);
    } else if (trace.tau_ext_of_driver.cols() > 0) {
      r.reference = ReferenceKind::kSender;
      Eigen::VectorXd::Map(r.tau_ext.data(), n) = trace.tau_ext_of_driver.col(k);
    }
    if (!trace.contact.empty()) r.contact = trace.contact[k] != 0;
  }
  return all;
}

void append_samples(const std::vector<Reading>& readings, MessageType type, LogBuffer& log) {
  for (const Reading& r : readings) log.append(channel_of(type), r.utime, write(r, type));
}

bool is_lcm_log(const std::string& path) {
  const std::string name = std::filesystem::path(path).filename().string();
  return name.ends_with(".lcm") || name.starts_with("lcmlog-");
}

void refuse_input_as_log(const std::string& url) {
  if (const std::string log = log_of(url); !log.empty()) refuse_input(log);
}

}  // namespace tauext
