// SPDX-License-Identifier: Apache-2.0
// What GpuHtmModel holds, for the passes of this layer.
#pragma once

#include <vector>

#include "gpu/buffer.h"
#include "gpu/gpu_image.h"
#include "gpu/handle.h"
#include "ibr/htm.h"

namespace ibr {

struct GpuHtmModel::State {
  State(Device& device, const HtmModel& model, const HtmPictureSource& source, const GpuHtmModelOptions& options);

  HtmBounds bounds;
  std::vector<Camera> cameras;
  std::vector<double> nearDistance;  // of each camera's depth map; nothing nearer counts
  std::uint32_t vertexCount = 0, triangleCount = 0;
  bool hasComplements = false;
  Buffer positions, triangles, members, complements;  // as shaders/shared/htm.h
  GpuImage photographs, depths;                       // a layer a camera, its picture in the corner at (0, 0)
  SamplerHandle photographSampler, depthSampler;

 private:
  void uploadMesh(const Device& device, const HtmModel& model);
  void uploadPhotographs(const Device& device, const HtmModel& model, const HtmPictureSource& source);
};

/// Throws Error{unsupported} where shaders cannot reach all of a buffer of `bytes`.
void checkHtmBuffer(const Device& device, std::uint64_t bytes, const char* name);

/// Draws the mesh's depth into every layer of `depths`, submits and waits.
void drawHtmDepths(const Device& device, const GpuHtmModel::State& model);

}  // namespace ibr
