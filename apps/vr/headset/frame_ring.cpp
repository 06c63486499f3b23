// SPDX-License-Identifier: Apache-2.0
#include "vr/headset/frame_ring.h"

#include <limits>
#include <vector>

#include "base/vulkan/functions.h"
#include "base/vulkan/submit.h"

namespace ibr::app {
namespace {

constexpr std::uint64_t kForever = std::numeric_limits<std::uint64_t>::max();
constexpr std::uint32_t kScopes = 64;

}  // namespace

FrameRing::FrameRing(const Device& device) : device_(device) {
  for (Slot& slot : slots_) {
    static_cast<FrameSlot&>(slot) = makeFrameSlot(device_);
    slot.timer = std::make_unique<ScopeTimer>(device_, kScopes);
  }
}

FrameRing::~FrameRing() {
  waitIdle(device_);  // a lost device counts as idle
}

void FrameRing::wait() const {
  for (const Slot& slot : slots_) {
    const VkFence done = slot.done.get();
    vk(device_, vkWaitForFences(device_.handle(), 1, &done, VK_TRUE, kForever), "vkWaitForFences");
  }
}

FrameRing::Frame FrameRing::begin() {
  const auto index = std::uint32_t(frames_ % kSlots);
  Slot& slot = slots_[index];
  const VkFence done = slot.done.get();
  vk(device_, vkWaitForFences(device_.handle(), 1, &done, VK_TRUE, kForever), "vkWaitForFences");
  deviceMs_ = 0;
  if (frames_ >= kSlots)
    for (const ScopeTime& time : slot.timer->read())
      if (time.depth == 0) deviceMs_ += time.milliseconds;
  beginCommands(device_, slot);
  slot.timer->reset(slot.commands);
  ++frames_;
  return {slot.commands, index, frames_, frames_ > kSlots ? frames_ - kSlots : 0, slot.timer.get()};
}

void FrameRing::submit(const Frame& frame) {
  const Slot& slot = slots_[frame.slot];
  vk(vkEndCommandBuffer(frame.commands), "vkEndCommandBuffer");
  const VkFence done = slot.done.get();
  vk(vkResetFences(device_.handle(), 1, &done), "vkResetFences");
  const VkCommandBufferSubmitInfo commands{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_SUBMIT_INFO,
                                           .commandBuffer = frame.commands};
  const VkSubmitInfo2 submission{
      .sType = VK_STRUCTURE_TYPE_SUBMIT_INFO_2, .commandBufferInfoCount = 1, .pCommandBufferInfos = &commands};
  const QueueLock lock(device_);
  vk(device_, vkQueueSubmit2(device_.queue(), 1, &submission, done), "vkQueueSubmit2");
}

}  // namespace ibr::app
