// SPDX-License-Identifier: Apache-2.0
// State of GpuHtmModel, for the passes of this layer.
#pragma once

#include <vector>

#include "base/vulkan/buffer.h"
#include "base/vulkan/gpu_image.h"
#include "base/vulkan/handle.h"
#include "gpu/transfer/upload.h"
#include "htm/depth_maps.h"
#include "ibr/htm.h"

namespace ibr {

struct GpuHtmModel::State {
  State(Device& device, const HtmModel& model, const HtmImageSource& source, const GpuHtmModelOptions& options);
  void replace(const HtmModel& model, const HtmImageSource& source, Uploads* uploads);

  HtmBounds bounds;
  std::vector<Camera> cameras;
  std::vector<double> nearDistance;  // near plane of each camera's depth map
  std::uint32_t vertexCount = 0, triangleCount = 0;
  bool hasComplements = false;
  Buffer positions, triangles, members, complements;  // layout: shaders/shared/htm.h
  GpuImage photographs, depths;                       // one layer per camera, its photograph in the corner at (0, 0)
  SamplerHandle photographSampler, depthSampler;

 private:
  void uploadMesh(const HtmModel& model, Uploader& uploader);
  void uploadPhotographs(const HtmModel& model, const HtmImageSource& source, Uploader& uploader);

  const Device* device_;
  HtmDepthMaps depthMaps_;
};

/// Makes a storage buffer of at least `bytes`; reuses a buffer that is large enough. Throws Error{unsupported} beyond
/// the range of shaders, Error{outOfMemory}: then `buffer` is null.
void makeHtmBuffer(const Device& device, Buffer& buffer, std::uint64_t bytes, const char* name);

}  // namespace ibr
