// SPDX-License-Identifier: Apache-2.0
// Colour tables on the device ([T] §2.5.3), made from histograms. The histograms come from an image of all cells side
// by side (ours), or from the paper's sequence.
//
// For each slot of the plan, the table that is shown and the table that it moves to stay from frame to frame. All other
// data lasts one frame. Each slot stores its cell, so a plan that is recorded and never submitted has no lasting
// effect.
#pragma once

#include <vulkan/vulkan_core.h>

#include <cstdint>

#include "base/vulkan/buffer.h"
#include "base/vulkan/handle.h"
#include "gpu/transfer/upload.h"
#include "ibr/device.h"
#include "ibr/renderer.h"
#include "shared/colour_map.h"

namespace ibr {

class ColourTables {
 public:
  /// Allocates for `cells` cells per frame, 1 to shader::kMaxMappedCells.
  ColourTables(Device& device, std::uint32_t cells, Uploader& uploader);

  /// For compute and fragment stages; bindings of shared/colour_map.h.
  VkDescriptorSetLayout setLayout() const noexcept { return setLayout_.get(); }
  /// `picture`: in the layout of use::kSampled when colours are counted or drawn from it. `canvas`: a storage image in
  /// GENERAL; null: no table is applied in place. At most four sets.
  VkDescriptorSet makeSet(const Device& device, VkImageView picture, VkImageView canvas);

  /// Packed entries (shader::packLevels), kLevels per slot; the identity follows after the last slot.
  VkBuffer tables() const noexcept { return tables_.get(); }
  const Buffer& tablesBuffer() const noexcept { return tables_; }
  const Buffer& counters() const noexcept { return counters_; }
  VkDeviceSize bytes() const noexcept {
    return frame_.size() + counters_.size() + slots_.size() + tables_.size() + noise_.size();
  }

  /// Waits for reads and writes of earlier frames, then writes the frame and, if frame.measured, clears its counters.
  void begin(VkCommandBuffer commands, const shader::ColourFrame& frame) const noexcept;
  /// Ours: counts the proxy's frame.count tiles. The proxy image must be visible to compute shaders.
  void count(VkCommandBuffer commands, VkDescriptorSet set, const shader::ColourFrame& frame) const noexcept;
  /// Makes the tables of cells first … last − 1. Waits for counting in compute and fragment shaders, and makes tables
  /// visible to both.
  void chain(VkCommandBuffer commands, VkDescriptorSet set, std::uint32_t first, std::uint32_t last) const noexcept;

 private:
  std::uint32_t cells_;
  Buffer frame_, counters_, slots_, tables_, noise_;
  SamplerHandle sampler_;
  DescriptorSetLayoutHandle setLayout_;
  DescriptorPoolHandle pool_;
  PipelineLayoutHandle layout_;
  PipelineHandle count_, chain_;
};

}  // namespace ibr
