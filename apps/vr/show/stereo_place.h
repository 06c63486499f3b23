// SPDX-License-Identifier: Apache-2.0
// A scene for two eyes, read and on the device ([T] §2.5.4): one order of cells from the middle of the eyes, weights
// for each eye, one colour mapping for both.
#pragma once

#include <array>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "ibr/gpu_scene.h"
#include "ibr/renderer.h"
#include "vr/headset/frame_ring.h"
#include "vr/walk/locomotion.h"

namespace ibr::app {

/// What is read of a scene's files, and what follows from it; it stays when a device is lost.
struct PlaceFiles {
  std::filesystem::path path;
  Scene scene;
  SceneBounds bounds;
  WalkPlace walk;
  glm::dvec3 middle{0};  // of the photographs
  bool canBeGathered = false;
  bool level = true;  // false: photographs were held in too many ways to tell where up is; then y is
};

/// For any thread. `unitsPerMetre`: of the world. Throws Error that names the file.
PlaceFiles readPlace(const std::filesystem::path& path, double unitsPerMetre);

/// How an eye's pictures are drawn.
struct EyeFormat {
  VkExtent2D extent{0, 0};
  VkFormat format = VK_FORMAT_UNDEFINED;
  std::array<std::vector<glm::vec2>, 2> hiddenArea;  // RendererOptions::hiddenArea
};

class StereoPlace {
 public:
  /// Puts it on the device: on any thread that has the device to itself, from then on one thread uses both. `levels`:
  /// all settings that it will be drawn with. Submits and waits. Throws Error.
  StereoPlace(Device device, std::shared_ptr<const PlaceFiles> files, std::span<const RenderSettings> levels,
              bool floor, const EyeFormat& eyes, const GpuSceneOptions& options);
  StereoPlace(const StereoPlace&) = delete;
  StereoPlace& operator=(const StereoPlace&) = delete;

  const PlaceFiles& files() const noexcept { return *files_; }
  bool canBeGathered() const noexcept { return files_->canBeGathered; }
  /// As for the constructor, from now on; pipelines are made anew. The device has finished all frames.
  void setLevels(std::span<const RenderSettings> levels);
  /// The eyes' hidden areas have changed: pipelines are made anew. The device has finished all frames.
  void setHiddenArea(const std::array<std::vector<glm::vec2>, 2>& area);

  /// Records both eyes' pictures; their order is settled by the frames before. `seconds`: since the frame before.
  void record(const FrameRing::Frame& frame, double seconds, const std::vector<Camera>& eyes,
              const RenderSettings& settings, std::span<const Target> targets);

  /// The eyes are elsewhere, and nobody saw how: what is drawn next owes nothing to what was drawn before.
  void forgetFrames() { plan_ = {}; }

  const FramePlan& plan() const noexcept { return plan_; }  // of the last frame

 private:
  Device device_;
  std::shared_ptr<const PlaceFiles> files_;
  GpuScene gpuScene_;
  EyeFormat eyes_;
  bool floor_;
  RendererOptions rendererOptions_;
  std::optional<Renderer> renderer_;
  FramePlan plan_;
};

}  // namespace ibr::app
