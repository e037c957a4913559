// SPDX-License-Identifier: Apache-2.0
/// @file
/// From samples to messages: fewer messages than samples, with every peak held.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "lcmtypes/reading.h"

namespace tauext {

/// What an estimate means as a force on the arm, each as force_t has it.
struct LiveForce {
  std::array<double, 3> force{};      ///< [N]
  std::array<double, 3> moment{};     ///< [N m]
  std::array<double, 6> seen{};       ///< [1]
  double left_over = 0;               ///< [N m]
  int link = 0;                       ///< from 1; 0: none
  std::array<double, 3> point{};      ///< [m]
  std::array<double, 3> direction{};  ///< [1]
};

/// What an estimator, and the detector behind it, said of one sample. Plain: it crosses threads.
struct LiveSample {
  Reading reading;          ///< what was measured
  Joints tau_ext_hat{};     ///< [N m] sign of (3)
  double step_us = 0;       ///< [us] what the update took
  double score = 0;         ///< [1] of the detector
  int stream = 0;           ///< which of the emitter's streams
  std::int8_t status = 0;   ///< of estimate_t
  std::int8_t contact = 0;  ///< of detection_t
  bool mark = false;        ///< whether the detector marks this sample
  LiveForce force;          ///< if the stream has a site
};

/// An estimator's messages: estimate_t on TAUEXT_ESTIMATE_<estimator>, and detection_t on
/// TAUEXT_DETECTION if there is a detector, and force_t on TAUEXT_FORCE if there is a site.
struct Stream {
  std::string estimator;  ///< its name, or specification
  std::string detector;   ///< "" for none
  std::string site{};     ///< "" for none
};

inline constexpr const char* kDetectionChannel = "TAUEXT_DETECTION";  ///< of detection_t
inline constexpr const char* kForceChannel = "TAUEXT_FORCE";          ///< of force_t
inline constexpr const char* kSummaryChannel = "TAUEXT_SUMMARY";      ///< of summary_t
inline constexpr const char* kSampleChannel = "TAUEXT_SAMPLE";        ///< of sample_t
inline constexpr const char* kEstimateChannel = "TAUEXT_ESTIMATE_";   ///< and the estimator's name

/// How many messages a stream's sender has numbered, on its channel of estimates and of its pair in
/// TAUEXT_DETECTION alike: what its summary says at the end. None if the summary is of a run
/// without a stream, or of another estimator.
std::optional<std::int64_t> messages_of(const summary_t& summary, std::string_view estimator);

/// Takes a message's channel, time [us] and bytes; false if it could not be sent.
using Sink = std::function<bool(const char* channel, std::int64_t utime, Bytes message)>;

/// Turns samples into messages; at most `rate` of them a second of sample time and channel, and one
/// at once for a mark. Each holds minima, maxima, marks and scores over the samples since the one
/// before. Allocates nothing after construction.
class Emitter {
 public:
  /// What became of the messages.
  struct Counts {
    std::int64_t sent = 0, failed = 0;  ///< messages
  };

  /// @param rate [1/s]; 0: a message for every sample
  /// @throws std::invalid_argument for a rate below 0 or not finite, or a channel longer than LCM's
  /// 63 characters
  Emitter(const std::vector<Stream>& streams, double rate, Sink sink);

  /// Holds a sample, and sends its stream's messages if they are due.
  void add(const LiveSample& sample);
  /// Sends what is held back.
  void flush();

  /// Of all streams.
  Counts counts() const { return counts_; }
  /// Of one stream, its detections included, its forces not: there is one for each estimate.
  const Counts& counts(int stream) const { return channels_[stream].counts; }

 private:
  struct Channel {
    std::string name;
    estimate_t estimate{};
    detection_t detection{};
    force_t force{};
    std::int64_t slot = 0;  // of the last message
    bool started = false;
    Counts counts;
  };

  static void begin(Channel& c, int n);
  static void hold(Channel& c, const LiveSample& s);
  static void hold(detection_t& d, const LiveSample& s);
  static void hold(force_t& f, const LiveSample& s);
  void emit(Channel& c);
  template <class Message>
  bool send(const char* name, Message& m);

  double rate_;
  Sink sink_;
  std::vector<Channel> channels_;
  std::vector<std::byte> buffer_;
  std::int64_t first_utime_ = 0;
  bool any_ = false;
  Counts counts_;
};

}  // namespace tauext
