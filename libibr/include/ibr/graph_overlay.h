// SPDX-License-Identifier: Apache-2.0
// The image graph as lines over a picture ([T] §2.4): photographs as frusta, panoramas as globes, cells as the lines
// between their photographs.
//
//   const GraphOverlay overlay(device, imageGraph(scene), {.frustumDepth = 0.3});
//   renderer.record(commandBuffer, plan, target);
//   overlay.record(commandBuffer, view, best, target);
#pragma once

#include <vulkan/vulkan_core.h>

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "ibr/camera.h"
#include "ibr/device.h"
#include "ibr/target.h"

namespace ibr {

struct Scene;

struct ImageGraph {
  std::vector<Camera> photographs;                // pinholes and panoramas
  std::vector<std::vector<std::uint32_t>> cells;  // photographs of each; none: photographs alone
};
ImageGraph imageGraph(const Scene& scene);

struct GraphOverlayOptions {
  double frustumDepth = 1;  // how long a frustum's edges are, world units, > 0; a panorama's globe is half as large
  // Of targets: 8-bit RGBA or BGRA, UNORM or SRGB.
  std::vector<VkFormat> formats{VK_FORMAT_R8G8B8A8_UNORM};
};

/// Records lines into the caller's picture. One thread at a time uses it; commands recorded by it must have finished
/// before it is destroyed. The device must outlive it, the graph need not.
class GraphOverlay {
 public:
  /// Submits an upload and waits. Throws Error{invalidInput} where a cell names a photograph that there is not, a
  /// position is not finite or frustumDepth not positive; Error (outOfMemory, unsupported).
  GraphOverlay(Device& device, const ImageGraph& graph, const GraphOverlayOptions& options);
  GraphOverlay(GraphOverlay&&) noexcept;
  GraphOverlay& operator=(GraphOverlay&&) noexcept;
  ~GraphOverlay();

  /// Outside a render pass; the target holds a picture and goes from `before` to `after`; its alpha stays. `view`: a
  /// pinhole with the target's extent, else a programmer's error. `best`: cells as a frame ranks them, the main cell
  /// first: these and their photographs have the colours of ranks (those of Overlay::wireframe), all others are grey.
  /// Nothing hides lines; they fade where they come nearer to the eye than frustumDepth. Nothing is submitted, waited
  /// for or allocated. Bound pipelines, viewport and scissor are lost.
  void record(VkCommandBuffer commandBuffer, const Camera& view, std::span<const std::uint32_t> best,
              const Target& target) const noexcept;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace ibr
