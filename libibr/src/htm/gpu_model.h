// SPDX-License-Identifier: Apache-2.0
// What GpuHtmModel holds, for the passes of this layer.
#pragma once

#include <vector>

#include "gpu/device/handle.h"
#include "gpu/transfer/buffer.h"
#include "gpu/transfer/gpu_image.h"
#include "htm/depth_maps.h"
#include "ibr/htm.h"

namespace ibr {

struct GpuHtmModel::State {
  State(Device& device, const HtmModel& model, const HtmPictureSource& source, const GpuHtmModelOptions& options);
  void replace(const HtmModel& model, const HtmPictureSource& source);

  HtmBounds bounds;
  std::vector<Camera> cameras;
  std::vector<double> nearDistance;  // of each camera's depth map; nothing nearer counts
  std::uint32_t vertexCount = 0, triangleCount = 0;
  bool hasComplements = false;
  Buffer positions, triangles, members, complements;  // as shaders/shared/htm.h
  GpuImage photographs, depths;                       // a layer a camera, its picture in the corner at (0, 0)
  SamplerHandle photographSampler, depthSampler;

 private:
  void uploadMesh(const HtmModel& model);
  void uploadPhotographs(const HtmModel& model, const HtmPictureSource& source);

  const Device* device_;
  HtmDepthMaps depthMaps_;
};

/// Makes a storage buffer of at least `bytes`; one that is as large already stays. Throws Error{unsupported} where
/// shaders could not reach all of it, Error{outOfMemory}: then `buffer` is null.
void makeHtmBuffer(const Device& device, Buffer& buffer, std::uint64_t bytes, const char* name);

}  // namespace ibr
