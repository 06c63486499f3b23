// SPDX-License-Identifier: Apache-2.0
#include "ibr/template_search_pass.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <limits>

#include "base/check.h"
#include "base/vulkan/barrier.h"
#include "base/vulkan/buffer.h"
#include "base/vulkan/functions.h"
#include "base/vulkan/pipeline.h"
#include "gpu/draw/descriptors.h"
#include "gpu/transfer/upload.h"
#include "image/template_tasks.h"
#include "shaders/template_search_comp.h"
#include "shared/template_search.h"

namespace ibr {
namespace {

using namespace shader;

// Tasks and samples are copied to the device byte by byte.
static_assert(sizeof(TemplateTask) == sizeof(SearchTask) &&
              offsetof(TemplateTask, first) == offsetof(SearchTask, first) &&
              offsetof(TemplateTask, count) == offsetof(SearchTask, count) &&
              offsetof(TemplateTask, start) == offsetof(SearchTask, start));
static_assert(sizeof(TemplateSample) == sizeof(glm::uvec2) && offsetof(TemplateSample, y) == 2 &&
              offsetof(TemplateSample, red) == 4 && offsetof(TemplateSample, blue) == 6 &&
              std::endian::native == std::endian::little);

constexpr BufferUse kEarlierRecords{use::kComputeReadWrite.stages | use::kTransferWrite.stages,
                                    use::kComputeReadWrite.access | use::kTransferWrite.access};

std::vector<std::uint32_t> texelsOf(const Image8& picture) {
  std::vector<std::uint32_t> texels(std::size_t(picture.width) * std::size_t(picture.height));
  const std::uint8_t* rgb = picture.values.data();
  for (std::uint32_t& texel : texels) {
    texel = std::uint32_t(rgb[0]) | std::uint32_t(rgb[1]) << 8 | std::uint32_t(rgb[2]) << 16;
    rgb += 3;
  }
  return texels;
}

std::vector<SearchPicture> placesOf(std::span<const Image8* const> pictures) {
  std::vector<SearchPicture> places;
  std::uint32_t first = 0;
  for (const Image8* picture : pictures) {
    places.push_back({{picture->width, picture->height}, first});
    first += std::uint32_t(picture->width) * std::uint32_t(picture->height);
  }
  return places;
}

void checkLimits(const Device& device, std::span<const Image8* const> pictures, TemplateCapacity capacity) {
  check(capacity.tasks > 0 && capacity.samples > 0, ErrorCode::invalidInput,
        "template search: capacity of {} tasks and {} samples must be positive", capacity.tasks, capacity.samples);
  const VkPhysicalDeviceLimits& limits = device.properties().limits;
  const std::size_t most = limits.maxStorageBufferRange;
  std::size_t pixels = 0;
  for (const Image8* picture : pictures) pixels += std::size_t(picture->width) * std::size_t(picture->height);
  check(pixels <= most / sizeof(std::uint32_t), ErrorCode::unsupported,
        "{}: images of {} MiB in total do not fit into a storage buffer; match on the CPU", device.name(),
        pixels >> 18);
  check(capacity.tasks <= std::min<std::size_t>(limits.maxComputeWorkGroupCount[0], most / sizeof(SearchTask)) &&
            capacity.samples <= most / sizeof(TemplateSample),
        ErrorCode::unsupported, "{}: {} tasks with {} samples exceed the limits of a dispatch", device.name(),
        capacity.tasks, capacity.samples);
}

}  // namespace

struct TemplateSearchPass::State {
  State(const Device& device, std::span<const Image8* const> pictures, TemplateCapacity capacity, Uploads* uploads);

  VkDeviceSize taskBytes() const { return set.size() * sizeof(SearchTask); }
  VkDeviceSize sampleBytes() const { return samples * sizeof(TemplateSample); }

  std::size_t pictureCount;
  TemplateCapacity capacity;
  std::array<Buffer, kTemplateBindings> buffers;
  Buffer hostTasks, hostSamples, hostFound;
  DescriptorSetLayoutHandle setLayout;
  DescriptorPoolHandle pool;
  VkDescriptorSet descriptors = VK_NULL_HANDLE;
  PipelineLayoutHandle layout;
  PipelineHandle pipeline;
  // Arguments of the last set().
  std::vector<TemplateTask> set;
  std::size_t samples = 0;
  SearchStep step{};
};

TemplateSearchPass::State::State(const Device& device, std::span<const Image8* const> pictures, TemplateCapacity most,
                                 Uploads* uploads)
    : pictureCount(pictures.size()), capacity(most) {
  checkTemplateImages(pictures);
  checkLimits(device, pictures, capacity);
  const auto make = [&](int binding, std::size_t bytes, const char* name) {
    buffers[std::size_t(binding)] =
        Buffer(device, std::max<std::size_t>(bytes, 16),
               VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT | VK_BUFFER_USAGE_TRANSFER_SRC_BIT,
               MemoryKind::device, name);
  };
  const std::vector<SearchPicture> places = placesOf(pictures);
  const SearchPicture& last = places.empty() ? SearchPicture{} : places.back();
  const std::size_t texelCount = last.firstTexel + std::size_t(last.size.x) * std::size_t(last.size.y);
  make(kBindingTemplateTexels, texelCount * sizeof(std::uint32_t), "searched images");
  make(kBindingTemplatePictures, places.size() * sizeof(SearchPicture), "layout of searched images");
  make(kBindingTemplateTasks, capacity.tasks * sizeof(SearchTask), "templates");
  make(kBindingTemplateSamples, capacity.samples * sizeof(TemplateSample), "samples of templates");
  make(kBindingTemplateFound, capacity.tasks * sizeof(SearchFound), "found templates");
  hostTasks = Buffer(device, capacity.tasks * sizeof(SearchTask), VK_BUFFER_USAGE_TRANSFER_SRC_BIT, MemoryKind::upload,
                     "templates upload");
  hostSamples = Buffer(device, capacity.samples * sizeof(TemplateSample), VK_BUFFER_USAGE_TRANSFER_SRC_BIT,
                       MemoryKind::upload, "samples of templates upload");
  hostFound = Buffer(device, capacity.tasks * sizeof(SearchFound), VK_BUFFER_USAGE_TRANSFER_DST_BIT,
                     MemoryKind::readback, "found templates readback");

  Uploader uploader(device, uploads);
  uploader.buffer(buffers[kBindingTemplatePictures], 0, std::as_bytes(std::span(places)));
  for (std::size_t i = 0; i < places.size(); ++i) {
    const std::vector<std::uint32_t> texels = texelsOf(*pictures[i]);
    uploader.buffer(buffers[kBindingTemplateTexels], VkDeviceSize(places[i].firstTexel) * sizeof(std::uint32_t),
                    std::as_bytes(std::span(texels)));
  }

  std::array<VkDescriptorSetLayoutBinding, kTemplateBindings> bindings;
  for (std::uint32_t b = 0; b < bindings.size(); ++b)
    bindings[b] = {b, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 1, VK_SHADER_STAGE_COMPUTE_BIT, nullptr};
  setLayout = makeSetLayout(device, bindings);
  const VkDescriptorPoolSize size{VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, kTemplateBindings};
  pool = makeDescriptorPool(device, 1, {&size, 1});
  descriptors = allocateSet(device, pool.get(), setLayout.get());
  for (std::uint32_t b = 0; b < bindings.size(); ++b) writeStorageBuffer(device, descriptors, b, buffers[b].get());
  const VkPushConstantRange constants{VK_SHADER_STAGE_COMPUTE_BIT, 0, sizeof(SearchStep)};
  const VkDescriptorSetLayout layouts[]{setLayout.get()};
  layout = makePipelineLayout(device, layouts, {&constants, 1});
  pipeline = makeComputePipeline(
      device, {.name = "template search", .shader = shaders::template_search_comp, .layout = layout.get()});
  uploader.flush();
}

TemplateSearchPass::TemplateSearchPass(const Device& device, std::span<const Image8* const> pictures,
                                       TemplateCapacity capacity, Uploads* uploads)
    : state_(std::make_unique<State>(device, pictures, capacity, uploads)) {}
TemplateSearchPass::TemplateSearchPass(TemplateSearchPass&&) noexcept = default;
TemplateSearchPass& TemplateSearchPass::operator=(TemplateSearchPass&&) noexcept = default;
TemplateSearchPass::~TemplateSearchPass() = default;

void TemplateSearchPass::set(std::span<const TemplateTask> tasks, std::span<const TemplateSample> samples, int radius,
                             TemplateMeasure measure) {
  checkTemplateTasks(tasks, samples, radius, state_->pictureCount);
  check(tasks.size() <= state_->capacity.tasks && samples.size() <= state_->capacity.samples, ErrorCode::invalidInput,
        "template search: {} tasks with {} samples exceed the capacity of {} tasks and {} samples", tasks.size(),
        samples.size(), state_->capacity.tasks, state_->capacity.samples);
  state_->set.assign(tasks.begin(), tasks.end());
  state_->samples = samples.size();
  state_->step = {radius, measure == TemplateMeasure::correlation ? kMeasureCorrelation : kMeasureDifferences};
  std::ranges::copy(std::as_bytes(tasks), state_->hostTasks.mapped().begin());
  std::ranges::copy(std::as_bytes(samples), state_->hostSamples.mapped().begin());
}

void TemplateSearchPass::record(VkCommandBuffer commands) const noexcept {
  const State& s = *state_;
  if (s.set.empty()) return;
  const auto copy = [&](const Buffer& from, const Buffer& to, VkDeviceSize bytes) {
    const VkBufferCopy region{0, 0, bytes};
    if (bytes > 0) vkCmdCopyBuffer(commands, from.get(), to.get(), 1, &region);
  };
  bufferBarrier(commands, kEarlierRecords, use::kTransferWrite);
  copy(s.hostTasks, s.buffers[kBindingTemplateTasks], s.taskBytes());
  copy(s.hostSamples, s.buffers[kBindingTemplateSamples], s.sampleBytes());
  bufferBarrier(commands, use::kTransferWrite, use::kComputeReadWrite);
  vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_COMPUTE, s.pipeline.get());
  vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_COMPUTE, s.layout.get(), 0, 1, &s.descriptors, 0, nullptr);
  vkCmdPushConstants(commands, s.layout.get(), VK_SHADER_STAGE_COMPUTE_BIT, 0, sizeof s.step, &s.step);
  vkCmdDispatch(commands, std::uint32_t(s.set.size()), 1, 1);
  bufferBarrier(commands, use::kComputeReadWrite, use::kTransferRead);
  copy(s.buffers[kBindingTemplateFound], s.hostFound, s.set.size() * sizeof(SearchFound));
  bufferBarrier(commands, use::kTransferWrite, use::kHostRead);
}

std::vector<TemplateMatch> TemplateSearchPass::matches() const {
  const State& s = *state_;
  std::vector<TemplateMatch> matches;
  matches.reserve(s.set.size());
  const int side = 2 * s.step.radius + 1;
  for (std::size_t t = 0; t < s.set.size(); ++t) {
    const TemplateTask& task = s.set[t];
    if (task.count == 0) {
      matches.push_back({task.start, std::numeric_limits<float>::infinity()});
      continue;
    }
    SearchFound found;
    std::memcpy(&found, &s.hostFound.mapped()[t * sizeof found], sizeof found);
    const float cost = s.step.measure == kMeasureCorrelation
                           ? std::bit_cast<float>(found.cost)
                           : float(found.cost) * (1.0f / (3.0f * float(task.count)));  // as on the CPU
    const int k = int(found.displacement);
    matches.push_back({task.start + glm::ivec2(k % side, k / side) - s.step.radius, cost});
  }
  return matches;
}

}  // namespace ibr
