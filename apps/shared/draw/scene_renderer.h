// SPDX-License-Identifier: Apache-2.0
// A scene on a device, and rendering of single images.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "ibr/graph_overlay.h"
#include "ibr/offscreen.h"
#include "ibr/renderer.h"
#include "shared/camera/camera_path.h"
#include "shared/cli/context.h"

namespace ibr::app {

/// Options of programs that render single images: with the log, and without threads, so that images do not depend on
/// timing.
GpuSceneOptions batchOptions(GpuSceneOptions options, const Context& context);

class SceneRenderer {
 public:
  /// `views`: all views that will be rendered; the largest determines the renderer's maximum extent. The scene must
  /// outlive this object.
  SceneRenderer(const Scene& scene, const std::vector<View>& views, const GpuSceneOptions& gpuScene,
                RendererOptions options, const Context& context);

  /// Images rendered from here on also show the image graph.
  void showGraph();

  struct Picture {
    Image8 image;                         // RGBA
    double milliseconds = 0;              // from planning until the image is on the host
    std::optional<FrameBuffers> buffers;  // if RendererOptions::buffers is set
  };
  /// Renders an image. `state` comes from the previous image of the same walk, `dtSeconds` is the time since. Single
  /// images take {} and 0.
  Picture render(const Camera& view, const RenderSettings& settings, PlanState& state, double dtSeconds = 0);

  /// Renders an image of each view: one view, or both eyes. `milliseconds` of each image is the time of both.
  std::vector<Picture> render(const std::vector<Camera>& views, const RenderSettings& settings, PlanState& state,
                              double dtSeconds = 0);

  std::string deviceName() const { return device_.name(); }

 private:
  void prepare(std::size_t eye, const Intrinsics& intrinsics);

  const Scene& scene_;
  SceneBounds bounds_;
  Device device_;
  GpuScene gpuScene_;
  Renderer renderer_;
  std::optional<GraphOverlay> graph_;
  std::uint64_t frame_ = 0;
  bool wantsBuffers_;
  std::array<std::optional<Offscreen>, 2> offscreen_;  // by eye
  std::array<std::optional<OffscreenBuffers>, 2> buffers_;
};

}  // namespace ibr::app
