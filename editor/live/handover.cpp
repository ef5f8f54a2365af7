#include "live/handover.h"

namespace nf::editor::live {

Handover::Handover(gpu::Device& device) : owner(device), device_(gpu::SecondUser{device}) {
  VkSemaphoreTypeCreateInfo type{.sType = VK_STRUCTURE_TYPE_SEMAPHORE_TYPE_CREATE_INFO,
                                 .semaphoreType = VK_SEMAPHORE_TYPE_TIMELINE};
  VkSemaphoreCreateInfo create{.sType = VK_STRUCTURE_TYPE_SEMAPHORE_CREATE_INFO, .pNext = &type};
  NF_VK(vkCreateSemaphore(device.handle, &create, nullptr, &timeline_));
}

Handover::~Handover() {
  for (gpu::LentImage& lent : images_) gpu::destroy(device_, lent.image);
  vkDestroySemaphore(device_.handle, timeline_, nullptr);
}

const gpu::LentImage& Handover::write(glm::uvec2 size) {
  gpu::LentImage& lent = images_[writing_];
  const VkExtent2D& has = lent.image.info.extent;
  if (!lent.image.handle || has.width != size.x || has.height != size.y) {
    gpu::destroy(device_, lent.image);
    lent.image = gpu::create_image(
        device_,
        {.extent = {size.x, size.y},
         .format = VK_FORMAT_R8G8B8A8_UNORM,
         .usage = VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT},
        "handover.picture");
  }
  // A value that a failed frame never told is skipped: nobody gets to know of it.
  lent.written = {timeline_, ++value_};
  return lent;
}

}  // namespace nf::editor::live
