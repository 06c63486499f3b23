// SPDX-License-Identifier: Apache-2.0
// A scene on a device, and single pictures of it.
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

GpuSceneOptions withLog(GpuSceneOptions options, const Context& context);

/// Submits streaming until all photographs that the plan shows are there, if the budget has room for them. `frame` is
/// the number of the last frame, all of them finished; it is raised. Throws Error{io} where photographs cannot be read.
void streamAll(Device& device, GpuScene& gpuScene, const FramePlan& plan, std::uint64_t& frame);

class SceneRenderer {
 public:
  /// `views` are those that will be asked for: the largest of them is RendererOptions::largest. The scene must outlive
  /// it.
  SceneRenderer(const Scene& scene, const std::vector<View>& views, const GpuSceneOptions& gpuScene,
                RendererOptions options, const Context& context);

  /// Pictures from now on show the image graph as well.
  void showGraph();

  struct Picture {
    Image8 image;                         // RGBA
    double milliseconds = 0;              // from planning until the picture is on the host
    std::optional<FrameBuffers> buffers;  // where RendererOptions::buffers are
  };
  /// `state` is that of the last picture of the same walk, `dtSeconds` the time since; {} and 0 for a picture by
  /// itself.
  Picture render(const Camera& view, const RenderSettings& settings, PlanState& state, double dtSeconds = 0);

  /// A picture of each view: one, or both eyes, of which each says the time that both took.
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
