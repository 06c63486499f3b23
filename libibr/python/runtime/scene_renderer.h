// SPDX-License-Identifier: Apache-2.0
// A scene on a device, rendered to images in host memory.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "ibr/gpu_scene.h"
#include "ibr/offscreen.h"
#include "ibr/renderer.h"
#include "runtime/planner.h"
#include "runtime/shared_device.h"

namespace ibr::python {

struct SceneRendererOptions {
  VkExtent2D maxExtent{0, 0};              // of an image
  std::optional<RenderSettings> settings;  // nullopt: Preset::balanced of the device's kind
  bool stereo = false, buffers = false;    // plans of two views; frameBuffers()
  GpuSceneOptions gpuScene;
};

/// Functions are thread-safe: they lock the device. All but the accessors release the interpreter's lock, which the
/// caller has.
class SceneRenderer {
 public:
  /// Throws Error (io, invalidInput, unsupported, outOfMemory, deviceLost).
  SceneRenderer(std::shared_ptr<const Scene> scene, const DeviceChoice& device, const SceneRendererOptions& options);
  SceneRenderer(const SceneRenderer&) = delete;
  SceneRenderer& operator=(const SceneRenderer&) = delete;
  ~SceneRenderer();

  /// Returns an image (RGBA) of each view. Throws Error{invalidInput} for a plan of another scene, and for one that the
  /// renderer was not made for.
  std::vector<Image8> images(const ScenePlan& plan);
  FrameBuffers frameBuffers(const ScenePlan& plan, std::size_t view);

  /// Device memory of the scene.
  std::uint64_t deviceBytes() const;

  const Planner& planner() const { return planner_; }
  const RenderSettings& settings() const { return settings_; }
  const std::shared_ptr<SharedDevice>& device() const { return device_; }

 private:
  void checkFits(const ScenePlan& plan) const;
  template <class Images>
  Images& sized(std::optional<Images>& images, const Intrinsics& intrinsics);

  Planner planner_;
  std::shared_ptr<SharedDevice> device_;
  RenderSettings settings_;
  RendererOptions options_;
  std::uint64_t frame_ = 0;  // of the streamed scene
  // Destroyed by the destructor, while it locks the device.
  std::optional<GpuScene> gpuScene_;
  std::optional<Renderer> renderer_;
  std::array<std::optional<Offscreen>, 2> offscreen_;  // by view
  std::optional<OffscreenBuffers> buffers_;
};

}  // namespace ibr::python
