// SPDX-License-Identifier: Apache-2.0
// Texture arrays: array images with photographs or depth textures of one size and format as layers.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "base/vulkan/gpu_image.h"
#include "ibr/texture.h"

namespace ibr {

VkFormat vulkanFormat(TextureFormat format) noexcept;

/// Photographs that can share a texture array, or depth textures (rg16f), which have one level.
struct TextureArrayClass {
  TextureFormat format = TextureFormat::rgba8;
  VkExtent2D extent{0, 0};                // of level 0
  std::uint32_t firstLevel = 0;           // the level that becomes level 0 of the array
  std::vector<std::uint32_t> items = {};  // numbers of StreamItems, ascending

  bool isDepth() const noexcept { return format == TextureFormat::rg16f; }
  std::uint32_t levels() const noexcept;  // of the array
  VkExtent2D arrayExtent() const noexcept;
  std::uint64_t layerBytes() const noexcept;  // of all levels; a device may add alignment
  std::string text() const;                   // "photographs 4000x3000 as bc1"
};

/// Returns the image parameters of a texture array with `layers` layers.
GpuImageInfo arrayInfo(const TextureArrayClass& arrayClass, std::uint32_t layers) noexcept;

/// Returns the number of layers that fit into `bytes`: at least 1, at most the device's limit and the number of items.
std::uint32_t layersWithin(const Device& device, const TextureArrayClass& arrayClass, std::uint64_t bytes);

inline constexpr std::uint64_t kMaxArrayBytes = std::uint64_t(256) << 20;  // of one array, unless a layer is larger

struct ArraySlot {
  std::uint32_t array = 0, layer = 0;
};

/// Texture arrays for all textures of the classes, filled in the items' order.
class FixedTextureArrays {
 public:
  FixedTextureArrays() = default;
  /// `itemCount`: of the scene. Throws Error (unsupported, outOfMemory).
  FixedTextureArrays(const Device& device, std::span<const TextureArrayClass> classes, std::size_t itemCount);

  /// Returns the memory that the constructor would allocate, bytes.
  static std::uint64_t bytes(const Device& device, std::span<const TextureArrayClass> classes);

  std::span<const GpuImage> arrays() const noexcept { return arrays_; }
  const GpuImage& image(std::uint32_t item) const noexcept { return arrays_[slots_[item].array]; }
  std::uint32_t layer(std::uint32_t item) const noexcept { return slots_[item].layer; }
  std::uint64_t depthBytes() const noexcept;      // allocated, of depth textures
  std::uint64_t allocatedBytes() const noexcept;  // of all

 private:
  std::vector<GpuImage> arrays_;
  std::vector<ArraySlot> slots_;  // by item; defined for items of the classes
};

}  // namespace ibr
