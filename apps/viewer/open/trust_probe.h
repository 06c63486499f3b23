// SPDX-License-Identifier: Apache-2.0
// What is known of a scene's pixels beside their colours, in pictures so small that it costs little. One thread.
#pragma once

#include <optional>

#include "ibr/offscreen.h"
#include "ibr/renderer.h"
#include "viewer/open/trust.h"

namespace ibr::app {

class Probe {
 public:
  /// Scene and device must outlive it.
  Probe(Device& device, const Scene& scene, const SceneBounds& bounds, const GpuScene& gpuScene);

  /// All of these submit and wait; what is to be sampled has been streamed by commands that are submitted. Throw Error.
  Trust trust(const Camera& view, const RenderSettings& settings);
  /// Along the viewing axis, world units, of what a pixel shows (px, inside the picture); nullopt where nothing is, or
  /// it is infinitely far.
  std::optional<double> depthAt(const Camera& view, const RenderSettings& settings, glm::dvec2 pixel);

 private:
  FramePlan planOf(const Camera& view, RenderSettings settings) const;
  FrameBuffers look(const FramePlan& plan);

  const Scene& scene_;
  const SceneBounds& bounds_;
  Device& device_;
  Renderer renderer_;
};

}  // namespace ibr::app
