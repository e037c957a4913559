// SPDX-License-Identifier: Apache-2.0
#include "lcmtypes/live_stream.h"

#include <readerwriterqueue/readerwriterqueue.h>

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <thread>
#include <utility>

namespace tauext {

using namespace std::chrono_literals;

namespace {
using Clock = std::chrono::steady_clock;
constexpr auto kIdle = 100ms;  // without samples, after which nothing is held back
}  // namespace

struct LiveStream::Shared {
  Shared(Sink sink, const std::vector<Stream>& streams, double rate, std::size_t capacity)
      : ring(capacity), emitter(streams, rate, std::move(sink)) {}

  // takes out what is there; true if there was something
  bool drain() {
    bool any = false;
    while (const LiveSample* next = ring.peek()) {
      if (stop.load(std::memory_order_acquire) && Clock::now() > deadline) {
        dropped.fetch_add(1, std::memory_order_relaxed);
      } else {
        emitter.add(*next);
      }
      ring.pop();
      publish_counts();
      any = true;
    }
    return any;
  }

  void publish_counts() {
    published.store(emitter.counts().sent, std::memory_order_relaxed);
    failed.store(emitter.counts().failed, std::memory_order_relaxed);
  }

  void run() {
    auto newest = Clock::now();
    while (!stop.load(std::memory_order_acquire)) {
      if (drain()) newest = Clock::now();
      if (Clock::now() - newest >
          kIdle) {  // the sender is silent: its last peaks and marks are news
        emitter.flush();
        publish_counts();
      }
      std::this_thread::sleep_for(1ms);
    }
    drain();
    emitter.flush();
    publish_counts();
    const std::lock_guard lock(mutex);
    done = true;
    finished.notify_all();
  }

  moodycamel::ReaderWriterQueue<LiveSample> ring;
  Emitter emitter;  // of the thread, until done
  std::atomic<std::int64_t> published = 0, failed = 0, dropped = 0;
  Clock::time_point deadline;  // written before stop
  std::atomic<bool> stop = false;
  std::mutex mutex;
  std::condition_variable finished;
  bool done = false;
};

LiveStream::LiveStream(std::shared_ptr<Transport> transport, const std::vector<Stream>& streams,
                       double rate, std::size_t capacity)
    : LiveStream(
          streams, rate,
          [transport = std::move(transport)](const char* channel, std::int64_t, Bytes message) {
            return transport && transport->publish(channel, message);
          },
          capacity) {}

LiveStream::LiveStream(const std::vector<Stream>& streams, double rate, Sink sink,
                       std::size_t capacity)
    : shared_(std::make_shared<Shared>(std::move(sink), streams, rate, capacity)) {
  std::thread([shared = shared_] { shared->run(); }).detach();
}

LiveStream::~LiveStream() {
  finish();
}

bool LiveStream::push(const LiveSample& sample) noexcept {
  const bool fits =
      !shared_->stop.load(std::memory_order_relaxed) && shared_->ring.try_enqueue(sample);
  if (!fits) shared_->dropped.fetch_add(1, std::memory_order_relaxed);
  return fits;
}

LiveStream::Counts LiveStream::counts() const noexcept {
  return {shared_->published.load(std::memory_order_relaxed),
          shared_->failed.load(std::memory_order_relaxed),
          shared_->dropped.load(std::memory_order_relaxed)};
}

Emitter::Counts LiveStream::counts(int stream) const {
  return shared_->emitter.counts(stream);
}

bool LiveStream::finish(double patience) {
  const auto limit =
      std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(patience));
  if (!shared_->stop.load()) shared_->deadline = Clock::now() + limit / 2;
  shared_->stop.store(true, std::memory_order_release);
  std::unique_lock lock(shared_->mutex);
  return shared_->finished.wait_for(lock, limit, [this] { return shared_->done; });
}

}  // namespace tauext
