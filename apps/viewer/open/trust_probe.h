// SPDX-License-Identifier: Apache-2.0
// Reads depth, tiers and uncertainty of a view from small images, which cost little. Threading: one thread.
#pragma once

#include <optional>

#include "ibr/offscreen.h"
#include "ibr/renderer.h"
#include "viewer/open/trust.h"

namespace ibr::app {

class TrustProbe {
 public:
  /// Scene, bounds and device must outlive the probe.
  TrustProbe(Device& device, const Scene& scene, const SceneBounds& bounds, const GpuScene& gpuScene);

  /// All methods submit and wait. Photographs must already be streamed by submitted commands. Throw Error.
  Trust trust(const Camera& view, const RenderSettings& settings);
  /// Returns the depth along the viewing axis, world units, at a pixel (px, inside the image); nullopt if the pixel is
  /// empty or infinitely far.
  std::optional<double> depthAt(const Camera& view, const RenderSettings& settings, glm::dvec2 pixel);

 private:
  FramePlan planOf(const Camera& view, RenderSettings settings) const;
  FrameBuffers renderBuffers(const FramePlan& plan);

  const Scene& scene_;
  const SceneBounds& bounds_;
  Device& device_;
  Renderer renderer_;
};

}  // namespace ibr::app
