// SPDX-License-Identifier: Apache-2.0
// GPU resources of an open scene or model, and how it is drawn. Threading: one thread.
#pragma once

#include <vulkan/vulkan_core.h>

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "ibr/device.h"
#include "ibr/gpu_scene.h"
#include "ibr/image.h"
#include "ibr/scope_timer.h"
#include "viewer/open/open_item.h"

namespace ibr::app {

/// A frame being recorded. Numbers start at 1; the device has finished frame `completed` and all frames before it.
struct FrameContext {
  VkCommandBuffer commands;
  std::uint64_t frame, completed;
  double seconds;  // since the previous frame
};

struct MemoryClass {
  std::string name;
  std::uint64_t bytes;
  bool ofScene;  // counts towards GpuSceneOptions::budgetBytes
};

struct TimedImage {
  Image8 image;
  double milliseconds;  // of a frame on the device
};

class ItemOnDevice {
 public:
  virtual ~ItemOnDevice() = default;

  /// Records the current view into the target, whose extent may change from frame to frame. Throws Error.
  virtual void record(const FrameContext& context, const Target& target, ScopeTimer* timer) = 0;

  /// Returns true if the next frame would differ with an unchanged view: streaming, a fade or 3D video in progress.
  virtual bool needsRedraw() const = 0;

  /// Draws the current view alone, as `ibr render` does, at this size. Waits for the device. Increases `frame` by the
  /// number of frames submitted. Throws Error.
  virtual Image8 picture(VkExtent2D extent, std::uint64_t& frame) = 0;

  /// Draws any view with any settings; the time is the median of a few frames. Otherwise as `picture`. Scenes only.
  virtual TimedImage timed(const Camera&, const RenderSettings&, std::uint64_t&) { return {}; }

  /// Returns the world point at a pixel of the view (px); nullopt: no surface is known there. Waits for the device.
  /// Throws Error.
  virtual std::optional<glm::dvec3> pointAt(VkExtent2D extent, glm::dvec2 pixel) = 0;

  /// Trust statistics of the current view. Waits for the device. Throws Error. nullopt for harmonised models.
  virtual std::optional<Trust> trust(VkExtent2D) { return std::nullopt; }

  /// Builds the pipelines again after shaders changed, so the image changes. Waits for the device. Throws Error, and
  /// then keeps the previous pipelines.
  virtual void rebuildPipelines() = 0;

  /// Plan of the last frame; nullptr for harmonised models.
  virtual const FramePlan* plan() const { return nullptr; }
  virtual std::vector<MemoryClass> memory() const = 0;
  /// Streaming statistics of the last frame; nullopt for harmonised models.
  virtual std::optional<GpuScene::StreamStatus> streamed() const { return std::nullopt; }
};

/// A scene on the device, and the Device that it was uploaded with.
struct UploadedScene {
  std::unique_ptr<Device> device;
  GpuScene scene;
};

/// May run on any thread, with a device of its own; afterwards one thread uses all devices. The scene must outlive the
/// result. Throws Error.
UploadedScene uploadScene(Device device, const Scene& scene, const GpuSceneOptions& options);

/// `item` may change meanwhile as OpenItem allows.
std::unique_ptr<ItemOnDevice> sceneOnDevice(Device& device, std::shared_ptr<OpenItem> item, UploadedScene uploaded);
/// For harmonised models and 3D video. Uploads and waits. Throws Error.
std::unique_ptr<ItemOnDevice> modelOnDevice(Device& device, std::shared_ptr<OpenItem> item);

}  // namespace ibr::app
