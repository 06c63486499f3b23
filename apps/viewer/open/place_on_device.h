// SPDX-License-Identifier: Apache-2.0
// What a device holds of a place, and how it is drawn. One thread.
#pragma once

#include <vulkan/vulkan_core.h>

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "gpu/draw/scope.h"
#include "ibr/gpu_scene.h"
#include "ibr/image.h"
#include "viewer/open/open_item.h"

namespace ibr::app {

/// A frame that is being recorded. Numbers rise from 1; `completed`: the device has finished it and all before it.
struct Moment {
  VkCommandBuffer commands;
  std::uint64_t frame, completed;
  double seconds;  // since the frame before
};

struct MemoryClass {
  std::string name;
  std::uint64_t bytes;
  bool ofScene;  // GpuSceneOptions::budgetBytes counts it
};

struct TimedPicture {
  Image8 image;
  double milliseconds;  // of a frame on the device
};

class PlaceOnDevice {
 public:
  virtual ~PlaceOnDevice() = default;

  /// Records the place as it is left into the target, whose extent may change from frame to frame. Throws Error.
  virtual void record(const Moment& moment, const Target& target, ScopeTimer* timer) = 0;

  /// What is drawn next would differ though nobody moved: something streams, fades or plays.
  virtual bool restless() const = 0;

  /// The same view by itself, as `ibr render` draws it, of that size. Waits for the device; `frame` is raised by the
  /// frames that it takes. Throws Error.
  virtual Image8 picture(VkExtent2D extent, std::uint64_t& frame) = 0;

  /// A picture of any view with any settings, and what it costs: the median of a few frames. As `picture`. Of scenes.
  virtual TimedPicture timed(const Camera&, const RenderSettings&, std::uint64_t&) { return {}; }

  /// The point of the world that a pixel of the view shows (px), where there is one. Waits for the device. Throws
  /// Error.
  virtual std::optional<glm::dvec3> pointAt(VkExtent2D extent, glm::dvec2 pixel) = 0;

  /// Of the view. Waits for the device. Throws Error. nullopt for harmonised models.
  virtual std::optional<Trust> trust(VkExtent2D) { return std::nullopt; }

  /// Makes the pipelines anew, after shaders have changed; what is drawn changes with them. Waits for the device.
  /// Throws Error, and then goes on with those that it had.
  virtual void remakePipelines() = 0;

  /// What the last frame was made of; nullptr for harmonised models.
  virtual const FramePlan* plan() const { return nullptr; }
  virtual std::vector<MemoryClass> memory() const = 0;
  /// Photographs of the last frame; none of harmonised models.
  virtual std::optional<GpuScene::Streamed> streamed() const { return std::nullopt; }
};

/// The place must outlive it, and may change in the meantime as OpenItem says. Submits uploads and waits. Throws Error.
std::unique_ptr<PlaceOnDevice> putOnDevice(Device& device, OpenItem& place, const GpuSceneOptions& options);

}  // namespace ibr::app
