// Rows of a picture over threads.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace nf::reference {

// Calls work(y) once for every row, on `threads` threads (0: all there are). Rethrows what a call threw.
template <class Work>
void for_rows(uint32_t rows, uint32_t threads, const Work& work) {
  std::atomic<uint32_t> next = 0;
  std::exception_ptr failure;
  std::mutex lock;
  const auto run = [&] {
    try {
      for (uint32_t y; (y = next++) < rows;) work(y);
    } catch (...) {
      const std::lock_guard hold(lock);
      failure = std::current_exception();
    }
  };
  const uint32_t count = std::clamp(threads ? threads : std::thread::hardware_concurrency(), 1u, 256u);
  std::vector<std::thread> others;
  for (uint32_t i = 1; i < count; ++i) others.emplace_back(run);
  run();
  for (std::thread& thread : others) thread.join();
  if (failure) std::rethrow_exception(failure);
}

}  // namespace nf::reference
