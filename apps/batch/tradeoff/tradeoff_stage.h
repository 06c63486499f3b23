// SPDX-License-Identifier: Apache-2.0
// Places on a device that are drawn in many ways, each prepared for what it needs and nothing else.
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
#include "gpu/draw/scope.h"
#include "ibr/offscreen.h"
#include "scene/memory_demand.h"
#include "shared/cli/context.h"

namespace ibr::app {

inline constexpr double kEyeDistance = 0.064;  // world units: m, where poses are metric

/// Time of a frame, ms.
struct TradeoffTimes {
  double plan = 0;                       // of the processor
  double device = 0;                     // of the device, from the first command to the last
  std::map<std::string, double> passes;  // of the device
  double frame() const { return plan + device; }
};

class TradeoffStage {
 public:
  /// `scenes`: the place, and further builds of it; they must outlive the stage. `largest`: of a picture.
  TradeoffStage(const std::vector<Scene>& scenes, VkExtent2D largest, const Context& context);

  /// Makes what a way needs, where it is not there. Throws Error.
  void prepare(const TradeoffWay& way);

  /// A picture by itself: RGBA, alpha of AlphaContent::tier, holes black. Of two views that of the first.
  Image8 picture(const TradeoffWay& way, const Camera& view);

  /// The picture of a plan for one view of this way.
  Image8 picture(const TradeoffWay& way, const FramePlan& plan);

  /// Throws Error{unsupported} where the queue has no timestamps.
  TradeoffTimes time(const TradeoffWay& way, const Camera& view);

  /// How far the eyes of a way with two views agree.
  EyeAgreement eyes(const TradeoffWay& way, const Camera& view) const;

  /// As `picture` draws it.
  FramePlan plan(const TradeoffWay& way, const Camera& view, double dtSeconds = 0, const PlanState& state = {}) const;

  Renderer::Counters count(const TradeoffWay& way, const FramePlan& plan);
  GpuScene::Memory memory(const TradeoffWay& way);
  /// [T] eq. 21 for the same (scene/memory_demand.h).
  MemoryDemand predicted(const TradeoffWay& way) const;

  const Device& device() const { return device_; }
  const Scene& scene(const TradeoffWay& way) const { return scenes_.at(way.build); }

 private:
  struct PreparedScene {
    GpuScene gpuScene;
    std::map<std::string, Renderer> renderers;  // by what they are prepared for
  };
  PreparedScene& placeOf(const TradeoffWay& way);
  Renderer& rendererOf(const TradeoffWay& way);
  std::vector<Target> targetsOf(const FramePlan& plan);
  Offscreen& offscreenOf(const Camera& view, std::size_t eye);
  FrameInput inputOf(const TradeoffWay& way, const Camera& view) const;

  const std::vector<Scene>& scenes_;
  VkExtent2D largest_;
  const Context& context_;
  std::vector<SceneBounds> bounds_;
  Device device_;
  std::map<std::string, PreparedScene> places_;         // by build, format and filter
  std::map<std::array<int, 3>, Offscreen> offscreens_;  // by width, height, eye
  ScopeTimer timer_;
};

/// Whether all textures of the scene are RGBA8, so that others can be made from them. Throws Error.
bool hasPlainTextures(const Scene& scene);

}  // namespace ibr::app
