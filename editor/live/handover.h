// Pictures that go from the renderer to the window on one VkDevice, without the host: three images, of which the
// renderer writes one, the window shows one, and the newest that is finished lies between. So neither waits for the
// other.
#pragma once

#include <array>
#include <glm/glm.hpp>
#include <utility>

#include "gpu/memory.h"

namespace nf::editor::live {

class Handover {
 public:
  // `device` is the window's; its second user is the renderer.
  explicit Handover(gpu::Device& device);
  // Neither may have any of it in use.
  ~Handover();
  Handover(const Handover&) = delete;
  Handover& operator=(const Handover&) = delete;

  gpu::Device& owner;

  // The renderer's thread: the image of the next picture, RGBA8, of this size; `written` is what its frame has to tell.
  const gpu::LentImage& write(glm::uvec2 size);
  // Under the mailbox's mutex, and the frame is done: what was written last is the newest.
  void publish() { std::swap(writing_, newest_); }
  // Likewise, and the window's frames are done: the newest, which was not taken yet, is shown from here on.
  void take() { std::swap(newest_, shown_); }

 private:
  gpu::Device device_;  // the images are made in the renderer's thread
  VkSemaphore timeline_ = VK_NULL_HANDLE;
  uint64_t value_ = 0;
  std::array<gpu::LentImage, 3> images_;
  uint8_t writing_ = 0, newest_ = 1, shown_ = 2;
};

}  // namespace nf::editor::live
