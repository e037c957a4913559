// SPDX-License-Identifier: Apache-2.0
#include "lcmtypes/live_stream.h"

#include <readerwriterqueue/readerwriterqueue.h>

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <thread>

namespace tauext {

using namespace std::chrono_literals;

struct LiveStream::Shared {
  Shared(Transport* transport, const std::vector<Stream>& streams, double rate,
         std::size_t capacity)
      : ring(capacity),
        emitter(streams, rate, [transport](const char* channel, std::int64_t, Bytes message) {
          return transport != nullptr && transport->publish(channel, message);
        }) {}

  void drain() {
    while (const LiveSample* next = ring.peek()) {
      emitter.add(*next);
      ring.pop();
    }
    publish_counts();
  }

  void publish_counts() {
    published.store(emitter.counts().sent, std::memory_order_relaxed);
    failed.store(emitter.counts().failed, std::memory_order_relaxed);
  }

  void run() {
    while (!stop.load(std::memory_order_acquire)) {
      drain();
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
  std::atomic<bool> stop = false;
  std::mutex mutex;
  std::condition_variable finished;
  bool done = false;
};

LiveStream::LiveStream(Transport* transport, const std::vector<Stream>& streams, double rate,
                       std::size_t capacity)
    : shared_(std::make_shared<Shared>(transport, streams, rate, capacity)) {
  std::thread([shared = shared_] { shared->run(); }).detach();
}

LiveStream::~LiveStream() {
  finish();
}

bool LiveStream::push(const LiveSample& sample) noexcept {
  const bool fits = shared_->ring.try_enqueue(sample);
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
  shared_->stop.store(true, std::memory_order_release);
  std::unique_lock lock(shared_->mutex);
  return shared_->finished.wait_for(lock, std::chrono::duration<double>(patience),
                                    [this] { return shared_->done; });
}

}  // namespace tauext
