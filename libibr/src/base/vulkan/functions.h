// SPDX-License-Identifier: Apache-2.0
// The functions of Vulkan, as pointers of namespace ibr: vkCmdDraw(…) in this namespace calls ibr::vkCmdDraw.
//
// Nothing here references a symbol of the Vulkan loader. Engines may define variables with the names of its functions
// (volk), and references to the loader would bind to these variables. Sources of the library, the programs and the
// tests that call Vulkan include this header; they compile with VK_NO_PROTOTYPES, so that a missing include is an
// error.
//
// The functions serve all instances and devices of the process. Functions of extensions that are not listed here come
// from vkGetInstanceProcAddr.
#pragma once

#include <vulkan/vulkan_core.h>

// Functions that need no instance.
#define IBR_GLOBAL_FUNCTIONS(X)             \
  X(vkCreateInstance)                       \
  X(vkEnumerateInstanceExtensionProperties) \
  X(vkEnumerateInstanceLayerProperties)

// Functions of Vulkan 1.0 to 1.3, which all drivers have that libibr can use.
#define IBR_CORE_FUNCTIONS(X)                 \
  X(vkAllocateCommandBuffers)                 \
  X(vkAllocateDescriptorSets)                 \
  X(vkAllocateMemory)                         \
  X(vkBeginCommandBuffer)                     \
  X(vkBindBufferMemory)                       \
  X(vkBindImageMemory)                        \
  X(vkCmdBeginRenderPass)                     \
  X(vkCmdBeginRendering)                      \
  X(vkCmdBindDescriptorSets)                  \
  X(vkCmdBindIndexBuffer)                     \
  X(vkCmdBindPipeline)                        \
  X(vkCmdBindVertexBuffers)                   \
  X(vkCmdBlitImage)                           \
  X(vkCmdClearColorImage)                     \
  X(vkCmdCopyBuffer)                          \
  X(vkCmdCopyBufferToImage)                   \
  X(vkCmdCopyImage)                           \
  X(vkCmdCopyImageToBuffer)                   \
  X(vkCmdDispatch)                            \
  X(vkCmdDraw)                                \
  X(vkCmdDrawIndexed)                         \
  X(vkCmdEndRenderPass)                       \
  X(vkCmdEndRendering)                        \
  X(vkCmdFillBuffer)                          \
  X(vkCmdPipelineBarrier2)                    \
  X(vkCmdPushConstants)                       \
  X(vkCmdResetQueryPool)                      \
  X(vkCmdSetScissor)                          \
  X(vkCmdSetViewport)                         \
  X(vkCmdUpdateBuffer)                        \
  X(vkCmdWriteTimestamp2)                     \
  X(vkCreateBuffer)                           \
  X(vkCreateCommandPool)                      \
  X(vkCreateComputePipelines)                 \
  X(vkCreateDescriptorPool)                   \
  X(vkCreateDescriptorSetLayout)              \
  X(vkCreateDevice)                           \
  X(vkCreateFence)                            \
  X(vkCreateFramebuffer)                      \
  X(vkCreateGraphicsPipelines)                \
  X(vkCreateImage)                            \
  X(vkCreateImageView)                        \
  X(vkCreatePipelineCache)                    \
  X(vkCreatePipelineLayout)                   \
  X(vkCreateQueryPool)                        \
  X(vkCreateRenderPass)                       \
  X(vkCreateSampler)                          \
  X(vkCreateSemaphore)                        \
  X(vkCreateShaderModule)                     \
  X(vkDestroyBuffer)                          \
  X(vkDestroyCommandPool)                     \
  X(vkDestroyDescriptorPool)                  \
  X(vkDestroyDescriptorSetLayout)             \
  X(vkDestroyDevice)                          \
  X(vkDestroyFence)                           \
  X(vkDestroyFramebuffer)                     \
  X(vkDestroyImage)                           \
  X(vkDestroyImageView)                       \
  X(vkDestroyInstance)                        \
  X(vkDestroyPipeline)                        \
  X(vkDestroyPipelineCache)                   \
  X(vkDestroyPipelineLayout)                  \
  X(vkDestroyQueryPool)                       \
  X(vkDestroyRenderPass)                      \
  X(vkDestroySampler)                         \
  X(vkDestroySemaphore)                       \
  X(vkDestroyShaderModule)                    \
  X(vkDeviceWaitIdle)                         \
  X(vkEndCommandBuffer)                       \
  X(vkEnumerateDeviceExtensionProperties)     \
  X(vkEnumeratePhysicalDevices)               \
  X(vkFreeMemory)                             \
  X(vkGetBufferMemoryRequirements)            \
  X(vkGetDeviceProcAddr)                      \
  X(vkGetDeviceQueue)                         \
  X(vkGetImageMemoryRequirements)             \
  X(vkGetPhysicalDeviceFeatures2)             \
  X(vkGetPhysicalDeviceFormatProperties)      \
  X(vkGetPhysicalDeviceImageFormatProperties) \
  X(vkGetPhysicalDeviceMemoryProperties)      \
  X(vkGetPhysicalDeviceMemoryProperties2)     \
  X(vkGetPhysicalDeviceProperties)            \
  X(vkGetPhysicalDeviceProperties2)           \
  X(vkGetPhysicalDeviceQueueFamilyProperties) \
  X(vkGetPipelineCacheData)                   \
  X(vkGetQueryPoolResults)                    \
  X(vkMapMemory)                              \
  X(vkQueueSubmit2)                           \
  X(vkQueueWaitIdle)                          \
  X(vkResetCommandPool)                       \
  X(vkResetFences)                            \
  X(vkUpdateDescriptorSets)                   \
  X(vkWaitForFences)

// Functions of VK_KHR_surface and VK_KHR_swapchain, for programs with a window. Null where the extension is missing.
#define IBR_WINDOW_FUNCTIONS(X)                \
  X(vkAcquireNextImageKHR)                     \
  X(vkCreateSwapchainKHR)                      \
  X(vkDestroySurfaceKHR)                       \
  X(vkDestroySwapchainKHR)                     \
  X(vkGetPhysicalDeviceSurfaceCapabilitiesKHR) \
  X(vkGetPhysicalDeviceSurfaceFormatsKHR)      \
  X(vkGetPhysicalDeviceSurfacePresentModesKHR) \
  X(vkGetPhysicalDeviceSurfaceSupportKHR)      \
  X(vkGetSwapchainImagesKHR)                   \
  X(vkQueuePresentKHR)

namespace ibr {

extern PFN_vkGetInstanceProcAddr vkGetInstanceProcAddr;
#define IBR_DECLARE(name) extern PFN_##name name;
IBR_GLOBAL_FUNCTIONS(IBR_DECLARE)
IBR_CORE_FUNCTIONS(IBR_DECLARE)
IBR_WINDOW_FUNCTIONS(IBR_DECLARE)
#undef IBR_DECLARE

/// Loads all functions from `getInstanceProcAddr`, or the global ones alone if `instance` is null: ensureFunctions()
/// then loads the rest. Throws Error: invalidInput for a null function; unsupported with the first missing function,
/// which leaves all functions as they were. No other thread may call Vulkan meanwhile.
void loadFunctions(PFN_vkGetInstanceProcAddr getInstanceProcAddr, VkInstance instance);

/// Loads the functions from libvulkan.so.1 unless some are loaded. Afterwards, the global functions may be called.
/// Throws Error{unsupported} if the loader is not installed or lacks a function; the next call tries again. Any thread.
void ensureGlobalFunctions();

/// As ensureGlobalFunctions; afterwards, all functions may be called. After loadFunctions() without an instance, loads
/// the rest from `instance`, and throws Error{invalidInput} if that is null.
void ensureFunctions(VkInstance instance);

}  // namespace ibr
