// Independent pieces of work over threads.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace nf {

// Calls work(row) once for every row, on `threads` threads (0: all there are). Rethrows what a call threw.
template <class Work>
void for_rows(uint32_t rows, uint32_t threads, const Work& work) {
  std::atomic<uint32_t> next = 0;
  std::exception_ptr failure;
  std::mutex lock;
  const auto run = [&] {
    try {
      for (uint32_t row; (row = next++) < rows;) work(row);
    } catch (...) {
      const std::lock_guard hold(lock);
      failure = std::current_exception();
    }
  };
  const uint32_t most = std::clamp(rows, 1u, 256u);
  const uint32_t count = std::clamp(threads ? threads : std::thread::hardware_concurrency(), 1u, most);
  std::vector<std::thread> others;
  for (uint32_t i = 1; i < count; ++i) others.emplace_back(run);
  run();
  for (std::thread& thread : others) thread.join();
  if (failure) std::rethrow_exception(failure);
}

}  // namespace nf
