// SPDX-License-Identifier: Apache-2.0
/// @file
/// The way out of a control loop: the loop pushes into a ring, a thread of ours does the rest.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "lcmtypes/emitter.h"
#include "lcmtypes/transport.h"

namespace tauext {

/// Publishes what one thread, the loop, pushes. The loop never waits: a push copies into a
/// lock-free ring, without a system call or an allocation; where the ring is full the sample is
/// dropped and counted.
class LiveStream {
 public:
  /// What became of what was pushed.
  struct Counts {
    std::int64_t published = 0, failed = 0;  ///< messages
    std::int64_t dropped = 0;                ///< samples that did not fit into the ring
  };

  /// @param transport used by no other thread until finish(); null or not good: messages count as
  /// failed
  /// @param rate [1/s] of messages of each channel; 0: one for every sample
  /// @param capacity samples that the ring holds
  /// @throws std::invalid_argument as Emitter does
  LiveStream(std::shared_ptr<Transport> transport, const std::vector<Stream>& streams, double rate,
             std::size_t capacity = 8192);
  /// The same to anything that takes messages.
  /// @param sink called from a thread of ours; what it holds may outlive this, see finish()
  LiveStream(const std::vector<Stream>& streams, double rate, Sink sink,
             std::size_t capacity = 8192);
  ~LiveStream();
  LiveStream(const LiveStream&) = delete;
  LiveStream& operator=(const LiveStream&) = delete;

  /// From the loop's thread alone. False: dropped; after finish(), always.
  bool push(const LiveSample& sample) noexcept;

  /// From any thread.
  Counts counts() const noexcept;
  /// Messages of one stream, once finish() is through.
  Emitter::Counts counts(int stream) const;

  /// Sends what is left and ends the thread; what it cannot send in `patience` seconds is dropped.
  /// False if even then a message does not return (a tcpq:// server that does not answer): the
  /// thread is left to itself, with the transport, which must not be used any more.
  bool finish(double patience = 2);

 private:
  struct Shared;
  std::shared_ptr<Shared> shared_;  // outlives us where the thread hangs
};

}  // namespace tauext
