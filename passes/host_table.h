// A table that changes between frames: two host-visible copies, so that a frame in flight reads one while the other is
// written (Executor::wait_for_side() comes first).
#pragma once

#include <array>
#include <cstring>
#include <utility>
#include <vector>

#include "gpu/frame_ring.h"
#include "gpu/memory.h"
#include "scene/update.h"

namespace nf::passes {

class HostTable {
 public:
  // `row_of(i)` gives row i. An empty table has 16 bytes, so that it can be bound.
  template <class Row, class F>
  void create(gpu::Device& device, size_t count, F&& row_of, const char* name) {
    for (gpu::Buffer& side : sides_)
      side = gpu::create_buffer(device, std::max<VkDeviceSize>(count * sizeof(Row), 16),
                                VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, gpu::Where::Host, name);
    last_ = {{0, uint32_t(count)}};
    update<Row>({}, row_of);
    last_ = {{0, uint32_t(count)}};
  }
  void destroy(gpu::Device& device) {
    for (gpu::Buffer& side : sides_) gpu::destroy(device, side);
  }

  // Writes these rows, and those that only the other side has, and makes that side the current one.
  template <class Row, class F>
  void update(const std::vector<scene::RowRange>& changed, F&& row_of) {
    if (changed.empty() && last_.empty()) return;
    current_ = 1 - current_;
    for (const std::vector<scene::RowRange>* ranges : {&std::as_const(last_), &changed})
      for (const scene::RowRange& range : *ranges)
        for (uint32_t i = range.first; i < range.first + range.count; ++i) {
          const Row row = row_of(i);
          std::memcpy(sides_[current_].mapped + size_t(i) * sizeof(Row), &row, sizeof row);
        }
    last_ = changed;
  }
  const gpu::Buffer& current() const { return sides_[current_]; }

 private:
  static_assert(gpu::FrameRing::size == 2);
  std::array<gpu::Buffer, 2> sides_;
  std::vector<scene::RowRange> last_;  // in the current side, not in the other
  size_t current_ = 0;
};

}  // namespace nf::passes
