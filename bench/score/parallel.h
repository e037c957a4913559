// SPDX-License-Identifier: Apache-2.0
/// @file
/// Independent work on all cores.
#pragma once

#include <algorithm>
#include <atomic>
#include <exception>
#include <functional>
#include <mutex>
#include <numeric>
#include <thread>
#include <vector>

namespace tauext {

/// Number of threads for `jobs` of them: 0 means one a core.
inline int thread_count(int jobs) {
  return jobs > 0 ? jobs : static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
}

/// The i-th of 0 to n - 1 in an order in which every stretch has work of all kinds, where
/// neighbours are alike: so the share that is done tells how much time is left, whenever it is
/// asked.
inline int mixed(int i, int n) {
  int step = std::max(1, static_cast<int>(0.618 * n));
  while (std::gcd(step, n) != 1) --step;
  return static_cast<int>(static_cast<long long>(i) * step % n);
}

/// Calls work(i) for i = 0 to n - 1 from several threads, in no order. After an exception no new
/// work begins, and it is thrown here.
/// @param done called from time to time with the share that is done, 0 to 1, by one thread at a
/// time
inline void parallel_for(int n, int threads, const std::function<void(int)>& work,
                         const std::function<void(double)>& done = nullptr) {
  std::atomic<int> next = 0;
  int finished = 0;
  std::exception_ptr error;
  std::mutex mutex;
  const auto run = [&] {
    for (int i = next++; i < n; i = next++) {
      try {
        work(i);
      } catch (...) {
        const std::lock_guard lock(mutex);
        if (!error) error = std::current_exception();
        next = n;
      }
      const std::lock_guard lock(mutex);
      ++finished;
      if (done) done(static_cast<double>(finished) / n);
    }
  };
  {
    std::vector<std::jthread> pool;
    for (int t = 1; t < thread_count(threads); ++t) pool.emplace_back(run);
    run();
  }
  if (error) std::rethrow_exception(error);
}

}  // namespace tauext
