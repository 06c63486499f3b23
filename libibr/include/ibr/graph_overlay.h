// SPDX-License-Identifier: Apache-2.0
// The image graph as lines over a rendered image ([T] §2.4): photographs as frusta, panoramas as globes, cells as lines
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
#include "ibr/export.h"
#include "ibr/target.h"
#include "ibr/uploads.h"

namespace ibr {

struct Scene;

/// Photographs and cells that a GraphOverlay draws.
struct ImageGraph {
  std::vector<Camera> photographs;                // cameras of pinholes and panoramas
  std::vector<std::vector<std::uint32_t>> cells;  // indices into `photographs`, by cell; empty: photographs alone
};
/// Returns the cameras of a scene's nodes, and its cells.
IBR_API ImageGraph imageGraph(const Scene& scene);

/// Options of a GraphOverlay.
struct GraphOverlayOptions {
  double frustumDepth = 1;  // length of a frustum's side edges, diameter of a panorama's globe; world units, > 0
  std::vector<TargetFormat> formats{VK_FORMAT_R8G8B8A8_UNORM};  // formats of targets
  Uploads* uploads = nullptr;  // collects the upload of the constructor instead of submitting and waiting
};

/// Records lines over the caller's image. One thread at a time uses it. Commands that it recorded must have finished
/// before it is destroyed. The device must outlive it; the graph need not.
class IBR_API GraphOverlay {
 public:
  /// Allocates host and device memory, builds pipelines, submits an upload on the device's queue and waits; with
  /// GraphOverlayOptions::uploads, neither. Throws Error{invalidInput} where a cell's index is out of range, a position
  /// is not finite or frustumDepth is not positive; Error (outOfMemory, unsupported).
  GraphOverlay(Device& device, const ImageGraph& graph, const GraphOverlayOptions& options);
  GraphOverlay(GraphOverlay&&) noexcept;
  GraphOverlay& operator=(GraphOverlay&&) noexcept;
  ~GraphOverlay();  // frees device memory; does not wait

  /// Draws over the target's contents, outside a render pass; alpha is kept. The target goes from `initialUse` to
  /// `finalUse`. Preconditions: `view` is a pinhole of the target's extent; the options name the target's format
  /// and encoding.
  /// `best`: cells by rank, main cell first. These cells and their photographs have their rank's colour, as in
  /// Overlay::wireframe; all others are grey. Lines are not depth-tested; they fade where they are nearer to the eye
  /// than frustumDepth. Submits, waits for and allocates nothing. Bound pipelines, viewport and scissor are undefined
  /// after it.
  void record(VkCommandBuffer commandBuffer, const Camera& view, std::span<const std::uint32_t> best,
              const Target& target) const noexcept;

 private:
  struct IBR_LOCAL State;
  std::unique_ptr<State> state_;
};

}  // namespace ibr
