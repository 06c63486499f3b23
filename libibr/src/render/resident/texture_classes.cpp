// SPDX-License-Identifier: Apache-2.0
#include "render/resident/texture_classes.h"

#include <algorithm>
#include <map>
#include <tuple>
#include <utility>

#include "base/check.h"
#include "render/resident/read_in_order.h"
#include "render/resident/stream_log.h"

namespace ibr {
namespace {

constexpr std::uint32_t kDepthReduction = 4;  // of the sides of depth textures to those of photographs

std::uint64_t largestHeap(const Device& device) {
  std::uint64_t bytes = 0;
  const VkPhysicalDeviceMemoryProperties& memory = device.memoryProperties();
  for (std::uint32_t i = 0; i < memory.memoryHeapCount; ++i)
    bytes = std::max<std::uint64_t>(bytes, memory.memoryHeaps[i].size);
  return bytes;
}

void checkExtent(const Device& device, const Node& node) {
  const Intrinsics& k = node.camera.intrinsics;
  const std::uint32_t largest = device.properties().limits.maxImageDimension2D;
  check(std::uint32_t(std::max(k.width, k.height)) <= largest, ErrorCode::unsupported,
        "{}: {}x{} exceeds the device's maximum image size of {}; build with a smaller --max-size", node.name, k.width,
        k.height, largest);
}

}  // namespace

std::uint64_t totalBytes(std::span<const TextureArrayClass> classes) {
  std::uint64_t bytes = 0;
  for (const TextureArrayClass& arrayClass : classes) bytes += arrayClass.layerBytes() * arrayClass.items.size();
  return bytes;
}

std::vector<TextureArrayClass> classify(const Device& device, const TextureLoader& loader,
                                        const std::vector<std::uint32_t>& nodes, JobQueue& jobs,
                                        const std::stop_token& stop) {
  const Scene& scene = loader.scene();
  for (const std::uint32_t node : nodes) checkExtent(device, scene.nodes[node]);
  std::map<std::tuple<int, int, TextureFormat>, TextureArrayClass> classes;
  readInOrder<TextureFormat>(
      jobs, nodes.size(), stop,
      [&](std::size_t i, const std::stop_token& reading) { return loader.format(nodes[i], reading); },
      [&](std::size_t i, TextureFormat format) {
        const Intrinsics& k = scene.nodes[nodes[i]].camera.intrinsics;
        const TextureArrayClass single{.format = format, .extent = {std::uint32_t(k.width), std::uint32_t(k.height)}};
        classes.try_emplace({k.width, k.height, format}, single).first->second.items.push_back(nodes[i]);
      });
  std::vector<TextureArrayClass> result;
  for (auto& [key, arrayClass] : classes) result.push_back(std::move(arrayClass));
  return result;
}

std::vector<TextureArrayClass> classifyDepths(const TextureLoader& loader, const std::vector<std::uint32_t>& nodes,
                                              JobQueue& jobs, const std::stop_token& stop) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, TextureArrayClass> classes;
  readInOrder<VkExtent2D>(
      jobs, nodes.size(), stop,
      [&](std::size_t i, const std::stop_token& reading) { return loader.depthExtent(nodes[i], reading); },
      [&](std::size_t i, VkExtent2D extent) {
        const TextureArrayClass single{.format = TextureFormat::rg16f, .extent = extent};
        classes.try_emplace({extent.width, extent.height}, single)
            .first->second.items.push_back(loader.items().depth(nodes[i]));
      });
  std::vector<TextureArrayClass> result;
  for (auto& [key, arrayClass] : classes) result.push_back(std::move(arrayClass));
  return result;
}

void decodeBlocks(const Device& device, const GpuSceneOptions& options, std::uint64_t otherBytes,
                  std::vector<TextureArrayClass>& classes) {
  std::vector<TextureArrayClass> decoded = classes;
  for (TextureArrayClass& arrayClass : decoded) arrayClass.format = TextureFormat::rgba8;
  const std::uint64_t before = totalBytes(classes), after = totalBytes(decoded);
  const bool software = device.kind() == DeviceKind::software;
  const bool budgeted = options.budgetBytes > 0;
  const bool fits = after <= largestHeap(device) / 2 && (!budgeted || after + otherBytes <= options.budgetBytes);
  // A software device is so slow with BC7 that RGBA8 is better, even if fewer photographs are resident.
  const auto faster = [&](TextureFormat format) {
    return software && (fits || (budgeted && format == TextureFormat::bc7));
  };
  for (std::size_t c = 0; c < classes.size(); ++c)
    if (!device.supportsBlockCompression() || options.blocks == BlockTextureMode::decode ||
        (options.blocks == BlockTextureMode::automatic && faster(classes[c].format)))
      classes[c].format = TextureFormat::rgba8;
  if (totalBytes(classes) == before) return;
  say(options.log, device.supportsBlockCompression() ? LogLevel::info : LogLevel::warning,
      "textures are decoded to RGBA8, {:.1f} MB instead of {:.1f} MB: {} {}", megabytes(totalBytes(classes)),
      megabytes(before), device.name(),
      !device.supportsBlockCompression()           ? "does not support block compression"
      : options.blocks == BlockTextureMode::decode ? "decodes textures as requested"
                                                   : "samples RGBA8 faster");
}

std::vector<TextureArrayClass> reduced(std::vector<TextureArrayClass> classes, std::uint32_t side) {
  for (TextureArrayClass& arrayClass : classes) {
    const std::uint32_t most = arrayClass.isDepth() ? std::max(1u, side / kDepthReduction) : side;
    while (std::max(arrayClass.arrayExtent().width, arrayClass.arrayExtent().height) > most) ++arrayClass.firstLevel;
  }
  return classes;
}

}  // namespace ibr
