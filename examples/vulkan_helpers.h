// SPDX-License-Identifier: Apache-2.0
// Plain Vulkan 1.3 for the examples, as in any Vulkan tutorial: device, images, buffers, pipelines, one submit. Objects
// destroy what they made. Errors are exceptions; an object whose constructor throws leaks, since the examples then end.
#pragma once

#include <vulkan/vulkan.h>

#include <cstdint>
#include <fstream>
#include <functional>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

namespace helpers {

inline void check(VkResult result, const char* call) {
  if (result != VK_SUCCESS) throw std::runtime_error(std::string(call) + ": VkResult " + std::to_string(result));
}

struct NotCopyable {
  NotCopyable() = default;
  NotCopyable(const NotCopyable&) = delete;
  NotCopyable& operator=(const NotCopyable&) = delete;
};

inline std::vector<const char*> pointers(const std::vector<std::string>& names) {
  std::vector<const char*> result;
  for (const std::string& name : names) result.push_back(name.c_str());
  return result;
}

struct Instance : NotCopyable {
  VkInstance handle = VK_NULL_HANDLE;

  Instance(std::uint32_t apiVersion, const std::vector<std::string>& extensions) {
    const VkApplicationInfo application{.sType = VK_STRUCTURE_TYPE_APPLICATION_INFO, .apiVersion = apiVersion};
    const std::vector<const char*> names = pointers(extensions);
    const VkInstanceCreateInfo info{.sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO,
                                    .pApplicationInfo = &application,
                                    .enabledExtensionCount = std::uint32_t(names.size()),
                                    .ppEnabledExtensionNames = names.data()};
    check(vkCreateInstance(&info, nullptr, &handle), "vkCreateInstance");
  }
  ~Instance() { vkDestroyInstance(handle, nullptr); }

  std::vector<VkPhysicalDevice> physicalDevices() const {
    std::uint32_t count = 0;
    check(vkEnumeratePhysicalDevices(handle, &count, nullptr), "vkEnumeratePhysicalDevices");
    std::vector<VkPhysicalDevice> devices(count);
    check(vkEnumeratePhysicalDevices(handle, &count, devices.data()), "vkEnumeratePhysicalDevices");
    return devices;
  }
};

/// A device with one queue. Owns nothing.
struct Gpu {
  VkPhysicalDevice physicalDevice = VK_NULL_HANDLE;
  VkDevice device = VK_NULL_HANDLE;
  VkQueue queue = VK_NULL_HANDLE;
  std::uint32_t queueFamily = 0;
};

struct Device : NotCopyable {
  Gpu gpu;

  /// `features`: a chain for VkDeviceCreateInfo::pNext.
  Device(VkPhysicalDevice physicalDevice, std::uint32_t queueFamily, const std::vector<std::string>& extensions,
         const void* features)
      : gpu{.physicalDevice = physicalDevice, .queueFamily = queueFamily} {
    const float priority = 1;
    const VkDeviceQueueCreateInfo queue{
        VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO, nullptr, 0, queueFamily, 1, &priority};
    const std::vector<const char*> names = pointers(extensions);
    const VkDeviceCreateInfo info{.sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO,
                                  .pNext = features,
                                  .queueCreateInfoCount = 1,
                                  .pQueueCreateInfos = &queue,
                                  .enabledExtensionCount = std::uint32_t(names.size()),
                                  .ppEnabledExtensionNames = names.data()};
    check(vkCreateDevice(physicalDevice, &info, nullptr, &gpu.device), "vkCreateDevice");
    vkGetDeviceQueue(gpu.device, queueFamily, 0, &gpu.queue);
  }
  ~Device() { vkDestroyDevice(gpu.device, nullptr); }
};

/// Records commands, submits them once and waits.
inline void submitAndWait(const Gpu& gpu, const std::function<void(VkCommandBuffer)>& record) {
  VkCommandPool pool = VK_NULL_HANDLE;
  const VkCommandPoolCreateInfo poolInfo{VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO, nullptr, 0, gpu.queueFamily};
  check(vkCreateCommandPool(gpu.device, &poolInfo, nullptr, &pool), "vkCreateCommandPool");
  VkCommandBuffer commands = VK_NULL_HANDLE;
  const VkCommandBufferAllocateInfo allocation{VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO, nullptr, pool,
                                               VK_COMMAND_BUFFER_LEVEL_PRIMARY, 1};
  check(vkAllocateCommandBuffers(gpu.device, &allocation, &commands), "vkAllocateCommandBuffers");
  const VkCommandBufferBeginInfo begin{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO};
  check(vkBeginCommandBuffer(commands, &begin), "vkBeginCommandBuffer");
  record(commands);
  check(vkEndCommandBuffer(commands), "vkEndCommandBuffer");
  const VkSubmitInfo submit{
      .sType = VK_STRUCTURE_TYPE_SUBMIT_INFO, .commandBufferCount = 1, .pCommandBuffers = &commands};
  check(vkQueueSubmit(gpu.queue, 1, &submit, VK_NULL_HANDLE), "vkQueueSubmit");
  check(vkQueueWaitIdle(gpu.queue), "vkQueueWaitIdle");
  vkDestroyCommandPool(gpu.device, pool, nullptr);
}

inline VkDeviceMemory allocate(const Gpu& gpu, const VkMemoryRequirements& needs, VkMemoryPropertyFlags wanted) {
  VkPhysicalDeviceMemoryProperties has;
  vkGetPhysicalDeviceMemoryProperties(gpu.physicalDevice, &has);
  for (std::uint32_t type = 0; type < has.memoryTypeCount; ++type) {
    if (!(needs.memoryTypeBits >> type & 1) || (has.memoryTypes[type].propertyFlags & wanted) != wanted) continue;
    const VkMemoryAllocateInfo info{VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO, nullptr, needs.size, type};
    VkDeviceMemory memory = VK_NULL_HANDLE;
    check(vkAllocateMemory(gpu.device, &info, nullptr, &memory), "vkAllocateMemory");
    return memory;
  }
  throw std::runtime_error("no suitable memory");
}

/// A buffer in memory that the host sees at `data`.
struct Buffer : NotCopyable {
  Gpu gpu;
  VkBuffer handle = VK_NULL_HANDLE;
  VkDeviceMemory memory = VK_NULL_HANDLE;
  void* data = nullptr;

  Buffer(const Gpu& on, VkDeviceSize bytes, VkBufferUsageFlags usage) : gpu(on) {
    const VkBufferCreateInfo info{.sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO, .size = bytes, .usage = usage};
    check(vkCreateBuffer(gpu.device, &info, nullptr, &handle), "vkCreateBuffer");
    VkMemoryRequirements needs;
    vkGetBufferMemoryRequirements(gpu.device, handle, &needs);
    memory = allocate(gpu, needs, VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT);
    check(vkBindBufferMemory(gpu.device, handle, memory, 0), "vkBindBufferMemory");
    check(vkMapMemory(gpu.device, memory, 0, VK_WHOLE_SIZE, 0, &data), "vkMapMemory");
  }
  ~Buffer() {
    vkDestroyBuffer(gpu.device, handle, nullptr);
    vkFreeMemory(gpu.device, memory, nullptr);
  }
};

/// An image with a view of each layer.
struct Image : NotCopyable {
  Gpu gpu;
  VkFormat format;
  VkExtent2D extent;
  VkImageAspectFlags aspect = format == VK_FORMAT_D32_SFLOAT ? VK_IMAGE_ASPECT_DEPTH_BIT : VK_IMAGE_ASPECT_COLOR_BIT;
  VkImage handle = VK_NULL_HANDLE;
  VkDeviceMemory memory = VK_NULL_HANDLE;
  std::vector<VkImageView> views;

  Image(const Gpu& on, VkFormat pixels, VkExtent2D size, VkImageUsageFlags usage, std::uint32_t layers = 1)
      : gpu(on), format(pixels), extent(size), views(layers) {
    const VkImageCreateInfo info{.sType = VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO,
                                 .imageType = VK_IMAGE_TYPE_2D,
                                 .format = format,
                                 .extent = {extent.width, extent.height, 1},
                                 .mipLevels = 1,
                                 .arrayLayers = layers,
                                 .samples = VK_SAMPLE_COUNT_1_BIT,
                                 .usage = usage};
    check(vkCreateImage(gpu.device, &info, nullptr, &handle), "vkCreateImage");
    VkMemoryRequirements needs;
    vkGetImageMemoryRequirements(gpu.device, handle, &needs);
    memory = allocate(gpu, needs, 0);
    check(vkBindImageMemory(gpu.device, handle, memory, 0), "vkBindImageMemory");
    for (std::uint32_t layer = 0; layer < layers; ++layer) {
      const VkImageViewCreateInfo view{.sType = VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO,
                                       .image = handle,
                                       .viewType = VK_IMAGE_VIEW_TYPE_2D,
                                       .format = format,
                                       .subresourceRange = {aspect, 0, 1, layer, 1}};
      check(vkCreateImageView(gpu.device, &view, nullptr, &views[layer]), "vkCreateImageView");
    }
  }
  ~Image() {
    for (const VkImageView view : views) vkDestroyImageView(gpu.device, view, nullptr);
    vkDestroyImage(gpu.device, handle, nullptr);
    vkFreeMemory(gpu.device, memory, nullptr);
  }
};

/// A barrier between two uses of an image. Use: any type with the fields layout, stages and access.
template <class Use>
void barrier(VkCommandBuffer commands, const Image& image, const Use& before, const Use& after) {
  const VkImageMemoryBarrier2 info{.sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER_2,
                                   .srcStageMask = before.stages,
                                   .srcAccessMask = before.access,
                                   .dstStageMask = after.stages,
                                   .dstAccessMask = after.access,
                                   .oldLayout = before.layout,
                                   .newLayout = after.layout,
                                   .image = image.handle,
                                   .subresourceRange = {image.aspect, 0, 1, 0, VK_REMAINING_ARRAY_LAYERS}};
  const VkDependencyInfo dependency{
      .sType = VK_STRUCTURE_TYPE_DEPENDENCY_INFO, .imageMemoryBarrierCount = 1, .pImageMemoryBarriers = &info};
  vkCmdPipelineBarrier2(commands, &dependency);
}

/// An array of textures, set 0 and binding 0 of fragment shaders, which read by texelFetch. The images must be in
/// SHADER_READ_ONLY_OPTIMAL when they are read.
struct Textures : NotCopyable {
  Gpu gpu;
  VkSampler sampler = VK_NULL_HANDLE;
  VkDescriptorSetLayout layout = VK_NULL_HANDLE;
  VkDescriptorPool pool = VK_NULL_HANDLE;
  VkDescriptorSet set = VK_NULL_HANDLE;

  Textures(const Gpu& on, const std::vector<const Image*>& images) : gpu(on) {
    const VkSamplerCreateInfo nearest{.sType = VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO};
    check(vkCreateSampler(gpu.device, &nearest, nullptr, &sampler), "vkCreateSampler");
    std::vector<VkDescriptorImageInfo> infos;
    for (const Image* image : images)
      infos.push_back({sampler, image->views[0], VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL});
    const auto count = std::uint32_t(infos.size());
    const VkDescriptorType type = VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER;
    const VkDescriptorSetLayoutBinding binding{0, type, count, VK_SHADER_STAGE_FRAGMENT_BIT, nullptr};
    const VkDescriptorSetLayoutCreateInfo layoutInfo{VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO, nullptr, 0, 1,
                                                     &binding};
    check(vkCreateDescriptorSetLayout(gpu.device, &layoutInfo, nullptr, &layout), "vkCreateDescriptorSetLayout");
    const VkDescriptorPoolSize size{type, count};
    const VkDescriptorPoolCreateInfo poolInfo{VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO, nullptr, 0, 1, 1, &size};
    check(vkCreateDescriptorPool(gpu.device, &poolInfo, nullptr, &pool), "vkCreateDescriptorPool");
    const VkDescriptorSetAllocateInfo allocation{VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO, nullptr, pool, 1,
                                                 &layout};
    check(vkAllocateDescriptorSets(gpu.device, &allocation, &set), "vkAllocateDescriptorSets");
    const VkWriteDescriptorSet write{.sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET,
                                     .dstSet = set,
                                     .descriptorCount = count,
                                     .descriptorType = type,
                                     .pImageInfo = infos.data()};
    vkUpdateDescriptorSets(gpu.device, 1, &write, 0, nullptr);
  }
  ~Textures() {
    vkDestroyDescriptorPool(gpu.device, pool, nullptr);
    vkDestroyDescriptorSetLayout(gpu.device, layout, nullptr);
    vkDestroySampler(gpu.device, sampler, nullptr);
  }
};

struct PipelineInfo {
  std::span<const std::uint32_t> vertex, fragment;  // SPIR-V
  VkFormat colour = VK_FORMAT_UNDEFINED;            // of the attachments
  VkFormat depth = VK_FORMAT_UNDEFINED;             // none, or tested: nearer is less
  bool writesDepth = false, blends = false;  // blends: by the fragment's alpha; otherwise fragments replace pixels
  std::uint32_t vec3Attributes = 0;          // of a vertex, interleaved in one buffer
  std::uint32_t constantBytes = 0;           // push constants of both shaders
  const Textures* textures = nullptr;
};

/// Draws lists of triangles, both sides of each.
struct Pipeline : NotCopyable {
  Gpu gpu;
  PipelineInfo info;
  VkPipelineLayout layout = VK_NULL_HANDLE;
  VkPipeline handle = VK_NULL_HANDLE;

  Pipeline(const Gpu& on, const PipelineInfo& wanted) : gpu(on), info(wanted) {
    const VkPushConstantRange constants{kStages, 0, info.constantBytes};
    const VkPipelineLayoutCreateInfo layoutInfo{.sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO,
                                                .setLayoutCount = info.textures ? 1u : 0u,
                                                .pSetLayouts = info.textures ? &info.textures->layout : nullptr,
                                                .pushConstantRangeCount = info.constantBytes > 0 ? 1u : 0u,
                                                .pPushConstantRanges = &constants};
    check(vkCreatePipelineLayout(gpu.device, &layoutInfo, nullptr, &layout), "vkCreatePipelineLayout");
    const VkPipelineShaderStageCreateInfo stages[]{stage(VK_SHADER_STAGE_VERTEX_BIT, info.vertex),
                                                   stage(VK_SHADER_STAGE_FRAGMENT_BIT, info.fragment)};
    const VkVertexInputBindingDescription binding{0, 12 * info.vec3Attributes, VK_VERTEX_INPUT_RATE_VERTEX};
    std::vector<VkVertexInputAttributeDescription> attributes;
    for (std::uint32_t i = 0; i < info.vec3Attributes; ++i)
      attributes.push_back({i, 0, VK_FORMAT_R32G32B32_SFLOAT, 12 * i});
    const VkPipelineVertexInputStateCreateInfo input{.sType = VK_STRUCTURE_TYPE_PIPELINE_VERTEX_INPUT_STATE_CREATE_INFO,
                                                     .vertexBindingDescriptionCount = info.vec3Attributes > 0 ? 1u : 0u,
                                                     .pVertexBindingDescriptions = &binding,
                                                     .vertexAttributeDescriptionCount = info.vec3Attributes,
                                                     .pVertexAttributeDescriptions = attributes.data()};
    const VkPipelineInputAssemblyStateCreateInfo assembly{VK_STRUCTURE_TYPE_PIPELINE_INPUT_ASSEMBLY_STATE_CREATE_INFO,
                                                          nullptr, 0, VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST};
    const VkPipelineViewportStateCreateInfo viewport{
        .sType = VK_STRUCTURE_TYPE_PIPELINE_VIEWPORT_STATE_CREATE_INFO, .viewportCount = 1, .scissorCount = 1};
    const VkPipelineRasterizationStateCreateInfo raster{
        .sType = VK_STRUCTURE_TYPE_PIPELINE_RASTERIZATION_STATE_CREATE_INFO, .lineWidth = 1};
    const VkPipelineMultisampleStateCreateInfo samples{VK_STRUCTURE_TYPE_PIPELINE_MULTISAMPLE_STATE_CREATE_INFO,
                                                       nullptr, 0, VK_SAMPLE_COUNT_1_BIT};
    const VkPipelineDepthStencilStateCreateInfo depth{
        .sType = VK_STRUCTURE_TYPE_PIPELINE_DEPTH_STENCIL_STATE_CREATE_INFO,
        .depthTestEnable = info.depth != VK_FORMAT_UNDEFINED,
        .depthWriteEnable = info.writesDepth,
        .depthCompareOp = VK_COMPARE_OP_LESS};
    const VkPipelineColorBlendAttachmentState blend{.blendEnable = info.blends,
                                                    .srcColorBlendFactor = VK_BLEND_FACTOR_SRC_ALPHA,
                                                    .dstColorBlendFactor = VK_BLEND_FACTOR_ONE_MINUS_SRC_ALPHA,
                                                    .dstAlphaBlendFactor = VK_BLEND_FACTOR_ONE,
                                                    .colorWriteMask = 0xf};
    const VkPipelineColorBlendStateCreateInfo blending{
        VK_STRUCTURE_TYPE_PIPELINE_COLOR_BLEND_STATE_CREATE_INFO, nullptr, 0, VK_FALSE, VK_LOGIC_OP_COPY, 1, &blend};
    const VkDynamicState states[]{VK_DYNAMIC_STATE_VIEWPORT, VK_DYNAMIC_STATE_SCISSOR};
    const VkPipelineDynamicStateCreateInfo dynamic{VK_STRUCTURE_TYPE_PIPELINE_DYNAMIC_STATE_CREATE_INFO, nullptr, 0, 2,
                                                   states};
    const VkPipelineRenderingCreateInfo rendering{.sType = VK_STRUCTURE_TYPE_PIPELINE_RENDERING_CREATE_INFO,
                                                  .colorAttachmentCount = 1,
                                                  .pColorAttachmentFormats = &info.colour,
                                                  .depthAttachmentFormat = info.depth};
    const VkGraphicsPipelineCreateInfo create{.sType = VK_STRUCTURE_TYPE_GRAPHICS_PIPELINE_CREATE_INFO,
                                              .pNext = &rendering,
                                              .stageCount = 2,
                                              .pStages = stages,
                                              .pVertexInputState = &input,
                                              .pInputAssemblyState = &assembly,
                                              .pViewportState = &viewport,
                                              .pRasterizationState = &raster,
                                              .pMultisampleState = &samples,
                                              .pDepthStencilState = &depth,
                                              .pColorBlendState = &blending,
                                              .pDynamicState = &dynamic,
                                              .layout = layout};
    check(vkCreateGraphicsPipelines(gpu.device, VK_NULL_HANDLE, 1, &create, nullptr, &handle),
          "vkCreateGraphicsPipelines");
    for (const VkPipelineShaderStageCreateInfo& made : stages) vkDestroyShaderModule(gpu.device, made.module, nullptr);
  }
  ~Pipeline() {
    vkDestroyPipeline(gpu.device, handle, nullptr);
    vkDestroyPipelineLayout(gpu.device, layout, nullptr);
  }

  /// Call between beginRendering and vkCmdEndRendering. `constants`: PipelineInfo::constantBytes bytes.
  void draw(VkCommandBuffer commands, std::uint32_t vertices, const void* constants = nullptr) const {
    vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, handle);
    if (info.textures)
      vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, layout, 0, 1, &info.textures->set, 0, nullptr);
    if (constants) vkCmdPushConstants(commands, layout, kStages, 0, info.constantBytes, constants);
    vkCmdDraw(commands, vertices, 1, 0, 0);
  }

 private:
  static constexpr VkShaderStageFlags kStages = VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT;

  VkPipelineShaderStageCreateInfo stage(VkShaderStageFlagBits kind, std::span<const std::uint32_t> words) const {
    const VkShaderModuleCreateInfo code{
        .sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO, .codeSize = words.size_bytes(), .pCode = words.data()};
    VkPipelineShaderStageCreateInfo result{
        .sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO, .stage = kind, .pName = "main"};
    check(vkCreateShaderModule(gpu.device, &code, nullptr, &result.module), "vkCreateShaderModule");
    return result;
  }
};

/// Begins rendering into whole images, which must be in attachment layouts. Loads the depth; stores both.
inline void beginRendering(VkCommandBuffer commands, const Image& colour, VkAttachmentLoadOp load,
                           const Image* depth = nullptr) {
  const VkRenderingAttachmentInfo colours{.sType = VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO,
                                          .imageView = colour.views[0],
                                          .imageLayout = VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL,
                                          .loadOp = load};
  const VkRenderingAttachmentInfo depths{.sType = VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO,
                                         .imageView = depth ? depth->views[0] : VK_NULL_HANDLE,
                                         .imageLayout = VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL};
  const VkRenderingInfo rendering{.sType = VK_STRUCTURE_TYPE_RENDERING_INFO,
                                  .renderArea = {{0, 0}, colour.extent},
                                  .layerCount = 1,
                                  .colorAttachmentCount = 1,
                                  .pColorAttachments = &colours,
                                  .pDepthAttachment = depth ? &depths : nullptr};
  vkCmdBeginRendering(commands, &rendering);
  const VkViewport viewport{0, 0, float(colour.extent.width), float(colour.extent.height), 0, 1};
  vkCmdSetViewport(commands, 0, 1, &viewport);
  vkCmdSetScissor(commands, 0, 1, &rendering.renderArea);
}

/// Copies an image of four bytes a pixel, in TRANSFER_SRC_OPTIMAL, for the host; layers lie side by side.
inline void copyToBuffer(VkCommandBuffer commands, const Image& image, const Buffer& buffer) {
  std::vector<VkBufferImageCopy> layers;
  for (std::uint32_t layer = 0; layer < image.views.size(); ++layer)
    layers.push_back({.bufferOffset = VkDeviceSize(4) * layer * image.extent.width,
                      .bufferRowLength = std::uint32_t(image.views.size()) * image.extent.width,
                      .imageSubresource = {image.aspect, 0, layer, 1},
                      .imageExtent = {image.extent.width, image.extent.height, 1}});
  vkCmdCopyImageToBuffer(commands, image.handle, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, buffer.handle,
                         std::uint32_t(layers.size()), layers.data());
  const VkMemoryBarrier2 toHost{.sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER_2,
                                .srcStageMask = VK_PIPELINE_STAGE_2_TRANSFER_BIT,
                                .srcAccessMask = VK_ACCESS_2_TRANSFER_WRITE_BIT,
                                .dstStageMask = VK_PIPELINE_STAGE_2_HOST_BIT,
                                .dstAccessMask = VK_ACCESS_2_HOST_READ_BIT};
  const VkDependencyInfo dependency{
      .sType = VK_STRUCTURE_TYPE_DEPENDENCY_INFO, .memoryBarrierCount = 1, .pMemoryBarriers = &toHost};
  vkCmdPipelineBarrier2(commands, &dependency);
}

/// Writes RGBA pixels as a PPM file, without alpha.
inline void writePpm(const char* path, const void* rgba, std::uint32_t width, std::uint32_t height) {
  std::ofstream file(path, std::ios::binary);
  file << "P6\n" << width << ' ' << height << "\n255\n";
  for (std::size_t i = 0; i < std::size_t(width) * height; ++i) file.write(static_cast<const char*>(rgba) + 4 * i, 3);
  if (!file.flush()) throw std::runtime_error(std::string(path) + ": cannot be written");
}

}  // namespace helpers
