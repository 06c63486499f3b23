// SPDX-License-Identifier: Apache-2.0
// Owners of Vulkan objects. The device must be done with an object before its handle is destroyed.
#pragma once

#include <vulkan/vulkan_core.h>

#include <utility>

#include "base/vulkan/functions.h"
#include "base/vulkan/vulkan.h"
#include "ibr/device.h"

namespace ibr {

/// Move-only; the device must outlive the handle. A default-made or moved-from handle is VK_NULL_HANDLE. `Destroy` is
/// the address of a pointer of base/vulkan/functions.h.
template <class T, auto Destroy>
class Handle {
 public:
  using Type = T;

  Handle() = default;
  Handle(VkDevice device, T handle) noexcept : device_(device), handle_(handle) {}
  Handle(Handle&& other) noexcept : device_(other.device_), handle_(std::exchange(other.handle_, VK_NULL_HANDLE)) {}
  Handle& operator=(Handle&& other) noexcept {
    if (this != &other) {
      reset();
      device_ = other.device_;
      handle_ = std::exchange(other.handle_, VK_NULL_HANDLE);
    }
    return *this;
  }
  ~Handle() { reset(); }

  T get() const noexcept { return handle_; }
  void reset() noexcept {
    if (handle_ != VK_NULL_HANDLE) (*Destroy)(device_, std::exchange(handle_, VK_NULL_HANDLE), nullptr);
  }

 private:
  VkDevice device_ = VK_NULL_HANDLE;
  T handle_ = VK_NULL_HANDLE;
};

using BufferHandle = Handle<VkBuffer, &vkDestroyBuffer>;
using CommandPoolHandle = Handle<VkCommandPool, &vkDestroyCommandPool>;
using DescriptorPoolHandle = Handle<VkDescriptorPool, &vkDestroyDescriptorPool>;
using DescriptorSetLayoutHandle = Handle<VkDescriptorSetLayout, &vkDestroyDescriptorSetLayout>;
using FenceHandle = Handle<VkFence, &vkDestroyFence>;
using FramebufferHandle = Handle<VkFramebuffer, &vkDestroyFramebuffer>;
using ImageHandle = Handle<VkImage, &vkDestroyImage>;
using ImageViewHandle = Handle<VkImageView, &vkDestroyImageView>;
using PipelineHandle = Handle<VkPipeline, &vkDestroyPipeline>;
using PipelineLayoutHandle = Handle<VkPipelineLayout, &vkDestroyPipelineLayout>;
using QueryPoolHandle = Handle<VkQueryPool, &vkDestroyQueryPool>;
using RenderPassHandle = Handle<VkRenderPass, &vkDestroyRenderPass>;
using SamplerHandle = Handle<VkSampler, &vkDestroySampler>;
using ShaderModuleHandle = Handle<VkShaderModule, &vkDestroyShaderModule>;

/// make<SamplerHandle>(device, vkCreateSampler, info, "vkCreateSampler"). Throws as vk() does.
template <class Owner, class Create, class Info>
Owner make(const Device& device, Create create, const Info& info, const char* call) {
  checkAlive(device, call);
  typename Owner::Type handle = VK_NULL_HANDLE;
  vk(device, create(device.handle(), &info, nullptr, &handle), call);
  return Owner(device.handle(), handle);
}

}  // namespace ibr
