// A table of which some rows change between frames: host-visible copies, so that frames in flight read some while
// another is written.
#pragma once

#include <array>
#include <cstring>
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
    for (Side& side : sides_)
      side.buffer = gpu::create_buffer(device, std::max<VkDeviceSize>(count * sizeof(Row), 16),
                                       VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, gpu::Where::Host, name);
    update<Row>({{0, uint32_t(count)}}, row_of);
  }
  void destroy(gpu::Device& device) {
    for (Side& side : sides_) gpu::destroy(device, side.buffer);
  }

  // Brings the next side up to date and makes it the current one. At most once a frame.
  template <class Row, class F>
  void update(const std::vector<scene::RowRange>& changed, F&& row_of) {
    if (changed.empty()) return;
    for (Side& side : sides_) side.missing.insert(side.missing.end(), changed.begin(), changed.end());
    current_ = (current_ + 1) % sides_.size();
    Side& side = sides_[current_];
    for (const scene::RowRange& range : side.missing)
      for (uint32_t i = range.first; i < range.first + range.count; ++i) {
        const Row row = row_of(i);
        std::memcpy(side.buffer.mapped + size_t(i) * sizeof(Row), &row, sizeof row);
      }
    side.missing.clear();
  }
  const gpu::Buffer& current() const { return sides_[current_].buffer; }

 private:
  struct Side {
    gpu::Buffer buffer;
    std::vector<scene::RowRange> missing;  // rows that changed since it was written
  };
  std::array<Side, gpu::FrameRing::table_sides> sides_;
  size_t current_ = 0;
};

}  // namespace nf::passes
