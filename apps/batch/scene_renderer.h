// SPDX-License-Identifier: Apache-2.0
// A scene on a device, and single pictures of it.
#pragma once

#include <optional>
#include <vector>

#include "batch/context.h"
#include "ibr/offscreen.h"
#include "ibr/renderer.h"
#include "shared/camera_path.h"

namespace ibr::app {

class SceneRenderer {
 public:
  /// `views` and `settings` are those that will be asked for: the largest view sets the size of the canvas. The scene
  /// must outlive it.
  SceneRenderer(const Scene& scene, const std::vector<View>& views, const RenderSettings& settings,
                const Context& context);

  struct Picture {
    Image8 image;             // RGBA
    double milliseconds = 0;  // from planning until the picture is on the host
  };
  /// `state` is that of the last picture of the same walk, `dtSeconds` the time since; {} and 0 for a picture by
  /// itself.
  Picture render(const Camera& view, const RenderSettings& settings, PlanState& state, double dtSeconds = 0);

  std::string deviceName() const { return device_.name(); }

 private:
  Offscreen& offscreen(int width, int height);

  const Scene& scene_;
  SceneBounds bounds_;
  Device device_;
  GpuScene gpuScene_;
  Renderer renderer_;
  std::optional<Offscreen> offscreen_;
};

}  // namespace ibr::app
