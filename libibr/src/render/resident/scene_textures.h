// SPDX-License-Identifier: Apache-2.0
// The photographs of a scene and their depth textures on the device: all, or under a budget stand-ins, beside those
// that are streamed (ibr/gpu_scene.h).
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <stop_token>
#include <vector>

#include "base/job_queue.h"
#include "gpu/transfer/upload.h"
#include "ibr/gpu_scene.h"
#include "render/resident/streamer.h"
#include "render/resident/texture_arrays.h"
#include "render/resident/texture_loader.h"

namespace ibr {

class SceneTextures {
 public:
  using Sampled = Streamer::Sampled;

  /// `otherBytes`: part of the budget that meshes use. Device and loader must outlive this object. Textures or their
  /// stand-ins are resident after uploader.flush().
  SceneTextures(const Device& device, const GpuSceneOptions& options, const TextureLoader& loader,
                std::vector<TextureArrayClass> classes, std::uint64_t otherBytes, Uploader& uploader, JobQueue& jobs);
  SceneTextures(const SceneTextures&) = delete;
  SceneTextures& operator=(const SceneTextures&) = delete;

  /// Returns the smallest memory of stand-ins: one pixel each.
  static std::uint64_t minBytes(const Device& device, const std::vector<TextureArrayClass>& classes);

  /// Texture array and layer that currently hold a texture or its stand-in.
  Sampled at(std::uint32_t item) const;

  bool streams() const noexcept { return streamed_.has_value(); }
  std::span<const TextureArrayClass> classes() const noexcept { return classes_; }
  const std::optional<StreamedTextures>& streamed() const noexcept { return streamed_; }
  /// Makes at() return textures that the streamer has loaded. The streamer must live while at() is called.
  void use(const Streamer& streamer) noexcept { streamer_ = &streamer; }

  std::uint64_t depthBytes() const noexcept;
  std::uint64_t allocatedBytes() const noexcept;  // depth textures included

 private:
  void fill(std::span<const TextureArrayClass> classes, Uploader& uploader, JobQueue& jobs,
            const std::stop_token& stop);
  void setUpStreaming(const GpuSceneOptions& options, Uploader& uploader, JobQueue& jobs);
  void setUpResidency(std::span<const TextureArrayClass> standIns, std::uint64_t budget);

  const Device* device_;
  const TextureLoader* loader_;
  LogCallback log_;
  std::vector<TextureArrayClass> classes_;
  FixedTextureArrays fixed_;  // arrays of all textures, or of their stand-ins
  std::uint64_t budget_ = 0, otherBytes_ = 0;
  std::optional<StreamedTextures> streamed_;
  const Streamer* streamer_ = nullptr;
};

}  // namespace ibr
