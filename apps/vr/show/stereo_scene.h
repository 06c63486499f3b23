// SPDX-License-Identifier: Apache-2.0
// A scene on the device, drawn for two eyes ([T] §2.5.4). Both share one draw order, computed midway between the eyes,
// and one colour mapping; each eye has its own blend weights.
#pragma once

#include <array>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <stop_token>
#include <string>
#include <vector>

#include "base/background.h"
#include "ibr/gpu_scene.h"
#include "ibr/renderer.h"
#include "vr/headset/frame_ring.h"
#include "vr/walk/locomotion.h"

namespace ibr::app {

/// Contents of a scene's files, and derived data; kept when the device is lost.
struct LoadedScene {
  std::filesystem::path path;
  Scene scene;
  SceneBounds bounds;
  WalkScene walk;
  glm::dvec3 middle{0};  // mean position of the photographs
  bool canBeGathered = false;
  bool level = true;  // false: the up direction is unknown, because photographs were held in too many ways; y is used
};

/// Reads the files. May run on any thread. `unitsPerMetre`: initial scale. `alignCells`: as in RenderSettings, so that
/// the first frame need not compute anchors. Throws Error that names the file, and Error{cancelled} soon after a stop
/// was requested.
LoadedScene readScene(const std::filesystem::path& path, double unitsPerMetre, bool alignCells,
                      const std::stop_token& stop);

/// Reads a scene on a thread of its own.
using SceneReading = Background<std::shared_ptr<const LoadedScene>>;

/// Format of the eyes' images.
struct EyeFormat {
  VkExtent2D extent{0, 0};
  VkFormat format = VK_FORMAT_UNDEFINED;
  std::array<std::vector<glm::vec2>, 2> hiddenArea;  // RendererOptions::hiddenArea
};

class StereoScene {
 public:
  /// Uploads the scene. May run on any thread that has the device to itself; afterwards one thread uses both. `levels`:
  /// all settings that the scene will be drawn with. Submits and waits. Throws Error; a stop of the options may be
  /// requested until the renderer is made.
  StereoScene(Device device, std::shared_ptr<const LoadedScene> files, std::span<const RenderSettings> levels,
              bool floor, const EyeFormat& eyes, const GpuSceneOptions& options);
  StereoScene(const StereoScene&) = delete;
  StereoScene& operator=(const StereoScene&) = delete;

  const LoadedScene& files() const noexcept { return *files_; }
  bool canBeGathered() const noexcept { return files_->canBeGathered; }
  /// Replaces the constructor's `levels` and builds pipelines again. The device must have finished all frames.
  void setLevels(std::span<const RenderSettings> levels);
  /// Replaces the hidden areas and builds pipelines again. The device must have finished all frames.
  void setHiddenArea(const std::array<std::vector<glm::vec2>, 2>& area);

  /// Records both eyes' images; the draw order depends on previous frames. `seconds`: since the previous frame.
  void record(const FrameRing::Frame& frame, double seconds, const std::array<Camera, 2>& eyes,
              const RenderSettings& settings, std::span<const Target> targets);

  /// Starts the draw order afresh after a jump of the view, without cross-fades from previous frames.
  void forgetFrames() { plan_ = {}; }

  const FramePlan& plan() const noexcept { return plan_; }                       // of the last frame
  const GpuScene::StreamStatus& streamed() const noexcept { return streamed_; }  // likewise

 private:
  Device device_;
  std::shared_ptr<const LoadedScene> files_;
  GpuScene gpuScene_;
  EyeFormat eyes_;
  bool floor_;
  RendererOptions rendererOptions_;
  std::optional<Renderer> renderer_;
  FrameInput input_;  // of the last frame
  FramePlan plan_;
  GpuScene::StreamStatus streamed_;
};

}  // namespace ibr::app
