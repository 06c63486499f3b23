// SPDX-License-Identifier: Apache-2.0
// The photographs of a scene on the device: all, or under a budget those that frames need (ibr/gpu_scene.h).
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "gpu/transfer/upload.h"
#include "ibr/gpu_scene.h"
#include "render/resident/photograph_stream.h"
#include "render/resident/residency.h"
#include "render/resident/texture_arrays.h"

namespace ibr {

class Photographs {
 public:
  /// `nodes`: shown nodes, ascending. `meshBytes`: part of the budget that meshes use. Device and scene must outlive
  /// this object. Photographs are resident after uploader.flush().
  Photographs(const Device& device, const Scene& scene, const GpuSceneOptions& options,
              const std::vector<std::uint32_t>& nodes, std::uint64_t meshBytes, Uploader& uploader);

  /// Texture array and layer that currently hold a photograph or its stand-in.
  struct Sampled {
    VkImageView view;
    std::uint32_t layer;
  };
  Sampled at(std::uint32_t node) const;

  bool streams() const noexcept { return streams_; }
  std::uint64_t allocatedBytes() const noexcept;

  /// As GpuScene::stream. `wanted`: nodes by urgency; the frame shows the first `needed`. Calls `evicting` before a
  /// texture array is destroyed. Precondition: streams().
  GpuScene::StreamStatus stream(VkCommandBuffer commandBuffer, std::span<const std::uint32_t> wanted,
                                std::size_t needed, std::uint64_t frame, std::uint64_t completedFrame,
                                const std::function<void(VkImageView)>& evicting);

  /// Allocates the ring of staging memory for stream(); once the constructor's uploads have released theirs.
  void startStreaming(std::uint64_t stagingBytes) { stream_ = PhotographStream(*device_, stagingBytes); }

  /// Returns an upper bound of the photographs that the budget can hold: longer lists of wanted nodes are useless.
  std::size_t maxResident() const noexcept { return maxResident_; }

 private:
  Texture load(std::uint32_t node, const TextureArrayClass& arrayClass) const;
  void fill(std::span<const TextureArrayClass> classes, Uploader& uploader);
  void setUpStreaming(Uploader& uploader);
  void setUpResidency(std::span<const TextureArrayClass> standIns, std::uint64_t budget);
  void runSteps(const std::function<void(VkImageView)>& evicting);
  void makeArray(const Residency::Step& step);
  void beginLoad(const Residency::Step& step);
  void report(const GpuScene::StreamStatus& streamed);

  const Device* device_;
  const Scene* scene_;
  TextureSource source_;
  LogCallback log_;
  std::vector<TextureArrayClass> classes_;
  FixedTextureArrays fixed_;  // arrays of all photographs, or of their stand-ins

  bool streams_ = false;
  std::uint64_t budget_ = 0, meshBytes_ = 0;
  std::vector<std::uint32_t> classOf_;         // of a node; Residency::kNone: not streamed, the stand-in has full size
  std::vector<std::uint32_t> layersPerArray_;  // of a class
  std::vector<GpuImage> arrays_;               // with the numbers of Residency
  Residency residency_;
  PhotographStream stream_;
  std::uint32_t loading_ = Residency::kNone;  // node
  std::size_t maxResident_ = 0;
  std::uint32_t reportedWithoutRoom_ = 0;
};

}  // namespace ibr
