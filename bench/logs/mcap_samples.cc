// SPDX-License-Identifier: Apache-2.0
#include "bench/logs/mcap_samples.h"

#include <fmt/format.h>

#include <cstdint>
#include <stdexcept>
#include <vector>

#include "mjcf/trace/read/bag/bag_messages.h"

namespace tauext {
namespace {

// the name of the torque, and what it is
JsonField torque_of(const RecordingContents& has, const std::string& path) {
  if (has.tau_is_current || has.without_gravity) {
    if (!has.torque_at_instants)
      throw std::runtime_error(
          fmt::format("{}: the log's {} until the next sample (`held` in its map), which MCAP "
                      "cannot say: write "
                      "a .csv, or an .npz",
                      path, has.tau_is_current ? "currents hold" : "torques without gravity hold"));
    return has.tau_is_current
               ? JsonField{"current", true, "[A] of the drives, read at t"}
               : JsonField{"tau_without_gravity", true,
                           "[N m] torque of each joint, read at t, less what holds the arm"};
  }
  return has.torque_at_instants
             ? JsonField{"tau_instant", true, "[N m] torque of each joint, read at t"}
             : JsonField{"tau", true, "[N m] torque of each joint, until the next sample"};
}

const JsonField kTime{"t", false, "[s] the time of the sample"};

McapTopic measured_topic(const RecordingContents& has, const JsonField& torque, bool has_force) {
  std::vector<JsonField> fields{kTime,
                                {"q", true, "[rad] position of each joint"},
                                {"qd", true, "[rad/s] its velocity"},
                                torque};
  if (has.has_driver)
    fields.push_back({"driver", true, "[N m] the robot driver's own estimate of tau_ext"});
  if (has_force)
    fields.push_back({"force", true, "[N] of a sensor, on the end effector, axes of the world"});
  const std::string type(kMeasuredType);
  return {"/measured", type, json_schema(type, fields), {}};
}

McapTopic truth_topic(const RecordingContents& has) {
  std::vector<JsonField> fields{kTime};
  if (has.has_truth)
    fields.push_back({"tau_ext", true, "[N m] true external torque, sign of equation (3)"});
  if (has.has_contact)
    fields.push_back({"contact", false, "0, 1: a collision, or 2: a touch on purpose"});
  const std::string type(kTruthType);
  return {"/truth", type, json_schema(type, fields), {}};
}

}  // namespace

McapSamples::McapSamples(McapWriter& to, const RecordingContents& has, const RecordedSample& first,
                         const std::string& path)
    : to_(to), has_(has), has_force_(first.force.size() > 0) {
  const JsonField torque = torque_of(has, path);
  torque_ = torque.name;
  measured_ = to_.add(measured_topic(has, torque, has_force_));
  if (has.has_truth || has.has_contact) truth_ = to_.add(truth_topic(has));
}

void McapSamples::put(std::string_view name, const Eigen::VectorXd& numbers) {
  message_.put(name, numbers.data(), static_cast<std::size_t>(numbers.size()));
}

void McapSamples::write(const RecordedSample& y, const Eigen::VectorXd& tau) {
  message_.clear();
  message_.put("t", y.t);
  put("q", y.q);
  put("qd", y.qd);
  put(torque_, tau);
  if (has_.has_driver) put("driver", y.driver);
  if (has_force_) put("force", y.force);
  to_.write(measured_, y.t, message_.finish());
  if (!truth_) return;
  message_.clear();
  message_.put("t", y.t);
  if (has_.has_truth) put("tau_ext", y.tau_ext);
  if (has_.has_contact) message_.put("contact", std::int64_t{y.contact});
  to_.write(*truth_, y.t, message_.finish());
}

void write_mcap(const Trace& trace, const std::string& path) {
  RecordingContents has;
  has.dof = trace.dof();
  has.torque_at_instants = trace.torque_at_instants;
  has.tau_is_current = trace.tau_is_current, has.without_gravity = trace.tau_without_gravity;
  has.has_truth = trace.has_truth(), has.has_contact = !trace.contact.empty();
  McapWriter file(path);
  McapSamples samples(file, has, {}, path);
  RecordedSample y;
  for (int k = 0; k < trace.size(); ++k) {
    y.t = trace.t[static_cast<std::size_t>(k)];
    y.q = trace.q.col(k), y.qd = trace.qd.col(k), y.tau = trace.tau.col(k);
    if (has.has_truth) y.tau_ext = trace.tau_ext.col(k);
    if (has.has_contact) y.contact = trace.contact[static_cast<std::size_t>(k)];
    samples.write(y, y.tau);
  }
  file.commit();
}

}  // namespace tauext
