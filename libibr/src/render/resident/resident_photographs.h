// SPDX-License-Identifier: Apache-2.0
// The photographs of a scene on the device: all, or under a budget those that frames need (ibr/gpu_scene.h).
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <stop_token>
#include <vector>

#include "base/job_queue.h"
#include "gpu/transfer/upload.h"
#include "ibr/gpu_scene.h"
#include "render/resident/streamed_photographs.h"
#include "render/resident/texture_arrays.h"
#include "render/resident/texture_loader.h"

namespace ibr {

class Photographs {
 public:
  using Sampled = StreamedPhotographs::Sampled;

  /// `nodes`: shown nodes, ascending. `meshBytes`: part of the budget that meshes use. Device and scene must outlive
  /// this object. The queue, made for GpuSceneOptions::readerThreads, must have been destroyed before this object is.
  /// Photographs are resident after uploader.flush().
  Photographs(const Device& device, const Scene& scene, const GpuSceneOptions& options,
              const std::vector<std::uint32_t>& nodes, std::uint64_t meshBytes, Uploader& uploader, JobQueue& jobs);
  Photographs(const Photographs&) = delete;
  Photographs& operator=(const Photographs&) = delete;

  /// Texture array and layer that currently hold a photograph or its stand-in.
  Sampled at(std::uint32_t node) const;

  bool streams() const noexcept { return streamed_ != nullptr; }
  /// Null where all photographs are resident.
  StreamedPhotographs* streamed() const noexcept { return streamed_.get(); }
  std::uint64_t allocatedBytes() const noexcept;

  /// Returns an upper bound of the photographs that the budget can hold: longer lists of wanted nodes are useless.
  std::size_t maxResident() const noexcept { return maxResident_; }

 private:
  void fill(std::span<const TextureArrayClass> classes, Uploader& uploader, JobQueue& jobs,
            const std::stop_token& stop);
  void setUpStreaming(const GpuSceneOptions& options, Uploader& uploader, JobQueue& jobs);
  StreamedPhotographs::Setup setUpResidency(std::span<const TextureArrayClass> standIns, std::uint64_t budget,
                                            const GpuSceneOptions& options);

  const Device* device_;
  const Scene* scene_;
  TextureLoader loader_;
  LogCallback log_;
  std::vector<TextureArrayClass> classes_;
  FixedTextureArrays fixed_;  // arrays of all photographs, or of their stand-ins
  std::uint64_t budget_ = 0, meshBytes_ = 0;
  std::size_t maxResident_ = 0;
  std::unique_ptr<StreamedPhotographs> streamed_;
};

}  // namespace ibr
