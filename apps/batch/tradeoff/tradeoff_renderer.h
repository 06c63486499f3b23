// SPDX-License-Identifier: Apache-2.0
// Scenes on a device for drawing in many variants; each variant gets its own GPU scene and renderer, prepared on
// demand.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "batch/bench/frame_bench.h"
#include "batch/evaluate/eye_agreement.h"
#include "batch/tradeoff/tradeoff_settings.h"
#include "ibr/memory_demand.h"
#include "ibr/offscreen.h"
#include "ibr/scope_timer.h"
#include "shared/cli/context.h"

namespace ibr::app {

inline constexpr double kEyeDistance = 0.064;  // world units; metres if poses are metric

/// Time of a frame, ms.
struct TradeoffTimes {
  double plan = 0;                       // CPU time
  double device = 0;                     // device time from the first command to the last
  std::map<std::string, double> passes;  // device time
  double frame() const { return plan + device; }
};

class TradeoffRenderer {
 public:
  /// `scenes`: the scene and further builds, which must outlive this object. `largest`: maximum extent of an image.
  TradeoffRenderer(const std::vector<Scene>& scenes, VkExtent2D largest, const Context& context);

  /// Creates the GPU scene and renderer for a variant, if missing. Throws Error.
  void prepare(const TradeoffVariant& variant);

  /// Renders a single image: RGBA, alpha of AlphaContent::tier, black holes. With two views returns the first one.
  Image8 picture(const TradeoffVariant& variant, const Camera& view);

  /// Renders a plan of this variant; returns the first view's image.
  Image8 picture(const TradeoffVariant& variant, const FramePlan& plan);

  /// Measures a frame. Throws Error{unsupported} if the queue has no timestamps.
  TradeoffTimes time(const TradeoffVariant& variant, const Camera& view);

  /// Compares the images of the two eyes of a variant with two views.
  EyeAgreement eyes(const TradeoffVariant& variant, const Camera& view) const;

  /// Returns the plan that `picture` draws.
  FramePlan plan(const TradeoffVariant& variant, const Camera& view, double dtSeconds = 0,
                 const PlanState& state = {}) const;

  Renderer::Counters count(const TradeoffVariant& variant, const FramePlan& plan);
  GpuScene::Memory memory(const TradeoffVariant& variant);
  /// Predicts the memory by [T] eq. 21 (ibr/memory_demand.h).
  MemoryDemand predicted(const TradeoffVariant& variant) const;

  const Device& device() const { return device_; }
  const Scene& scene(const TradeoffVariant& variant) const { return scenes_.at(variant.build); }

 private:
  struct PreparedScene {
    GpuScene gpuScene;
    std::map<std::string, Renderer> renderers;  // by RendererOptions
  };
  PreparedScene& preparedScene(const TradeoffVariant& variant);
  Renderer& rendererOf(const TradeoffVariant& variant);
  std::vector<Target> targetsOf(const FramePlan& plan);
  Offscreen& offscreenOf(const Camera& view, std::size_t eye);
  FrameInput inputOf(const TradeoffVariant& variant, const Camera& view) const;

  const std::vector<Scene>& scenes_;
  VkExtent2D largest_;
  const Context& context_;
  std::vector<SceneBounds> bounds_;
  Device device_;
  std::map<std::string, PreparedScene> preparedScenes_;  // by build, format and filter
  std::map<std::array<int, 3>, Offscreen> offscreens_;   // by width, height, eye
  ScopeTimer timer_;
};

/// True if all textures of the scene are RGBA8, so that they can be converted to other formats. Throws Error.
bool hasPlainTextures(const Scene& scene);

}  // namespace ibr::app
