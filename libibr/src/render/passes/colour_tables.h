// SPDX-License-Identifier: Apache-2.0
// Colour tables on the device: histograms of a picture in which all cells lie side by side, or as the paper's sequence
// fills them, become tables ([T] §2.5.3; ARCHITECTURE §5 "Colour tables, in parallel").
//
// Between frames it keeps, per slot of the plan, what the table shows and where it is going. Everything else lives for
// a frame. A slot is marked with its cell, so a plan that was recorded and never submitted leaves nothing wrong behind.
#pragma once

#include <vulkan/vulkan_core.h>

#include <cstdint>

#include "gpu/device/handle.h"
#include "gpu/transfer/buffer.h"
#include "ibr/device.h"
#include "ibr/renderer.h"
#include "shared/colour_map.h"

namespace ibr {

class ColourTables {
 public:
  /// Room for `cells` cells a frame, at most shader::kLargestMapped, at least 1.
  ColourTables(Device& device, std::uint32_t cells);

  /// Compute and fragment stages; bindings of shared/colour_map.h.
  VkDescriptorSetLayout setLayout() const noexcept { return setLayout_.get(); }
  /// `picture`: in use::kSampled's layout when counted or drawn from. `canvas`: a storage image in GENERAL, or null
  /// where nothing is mapped in place. At most four sets.
  VkDescriptorSet makeSet(const Device& device, VkImageView picture, VkImageView canvas);

  /// Packed entries (shader::packLevels), kLevels a slot; after the slots the identity.
  VkBuffer tables() const noexcept { return tables_.get(); }
  const Buffer& tablesBuffer() const noexcept { return tables_; }
  const Buffer& counters() const noexcept { return counters_; }
  VkDeviceSize bytes() const noexcept {
    return frame_.size() + counters_.size() + slots_.size() + tables_.size() + noise_.size();
  }

  /// Waits for earlier frames' reads and writes, writes the frame and clears its counters where frame.measured.
  void begin(VkCommandBuffer commands, const shader::ColourFrame& frame) const noexcept;
  /// Ours: counts the proxy's frame.count tiles. The picture is visible to compute shaders.
  void count(VkCommandBuffer commands, VkDescriptorSet set, const shader::ColourFrame& frame) const noexcept;
  /// Makes the tables of cells first … last − 1. Waits for counting in compute and fragment shaders; tables are visible
  /// to both afterwards.
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
