// SPDX-License-Identifier: Apache-2.0
/// @file
/// Messages as JSON by UDP, for PlotJuggler's UDP server with its parser of JSON.
#pragma once

#include <string>
#include <string_view>

#include "lcmtypes/wire.h"

namespace tauext::live {

/// A message as an object: {"timestamp": 1.25, "ekf": {"tau_ext_hat": [..], ..}}. Estimates stand
/// under their estimator, detections and forces under it and "detection" or "force", samples under
/// their channel. "" for what is none of these.
std::string json_of(std::string_view channel, Bytes message);

/// Sends each message as a datagram; what cannot be sent is lost, as UDP is.
class PlotJuggler {
 public:
  static constexpr const char* kUsual = "127.0.0.1:9870";  ///< where PlotJuggler listens

  /// @param to HOST:PORT
  /// @throws std::invalid_argument for another form or port, std::runtime_error for a host that is
  /// not known
  explicit PlotJuggler(const std::string& to);
  ~PlotJuggler();
  PlotJuggler(const PlotJuggler&) = delete;
  PlotJuggler& operator=(const PlotJuggler&) = delete;

  const std::string& to() const { return to_; }                 ///< as constructed
  void send(std::string_view channel, Bytes message) noexcept;  ///< waits for nobody

 private:
  std::string to_;
  int socket_ = -1;
};

}  // namespace tauext::live
