// SPDX-License-Identifier: Apache-2.0
#include "batch/bench/frame_bench.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/quaternion.hpp>
#include <optional>

#include "base/check.h"
#include "ibr/gpu_scene.h"
#include "ibr/offscreen.h"
#include "ibr/scope_timer.h"

namespace ibr::app {
namespace {

constexpr double kEyeDistance = 0.064;  // m
constexpr double kHiddenCorner = 0.3;   // of the image's sides; hides 18 % of the pixels, as in headsets

std::vector<BenchVariant> variantsOf(const BenchCase& wanted) {
  const BlendMode blend = wanted.settings.blend;
  const auto paper = DrawOrder::paper, ours = DrawOrder::ours;
  std::vector<BenchVariant> ways{{"paper", paper, ColourMapping::off, blend, 1},
                                 {"ours", ours, ColourMapping::off, blend, 1},
                                 {"paper", paper, ColourMapping::paper, blend, 1},
                                 {"paper", paper, ColourMapping::paperRedraw, blend, 1},
                                 {"ours", ours, ColourMapping::ours, blend, 1}};
  if (blend == BlendMode::blend) ways.push_back({"ours", ours, ColourMapping::off, BlendMode::dither, 1});
  if (wanted.stereo) {
    ways.push_back({"paper", paper, ColourMapping::off, blend, 2});
    ways.push_back({"ours", ours, ColourMapping::off, blend, 2});
    ways.push_back({"ours", ours, ColourMapping::off, blend, 2, true});
    ways.push_back({"ours", ours, ColourMapping::ours, blend, 2});
  }
  return ways;
}

std::vector<Camera> eyesOf(const Camera& middle, std::size_t views) {
  return views == 1 ? std::vector{middle} : eyesAround(middle, kEyeDistance);
}

std::vector<WeightedPlan> plansOf(const BenchSubject& subject, const SceneBounds& bounds, const RenderSettings& common,
                                  const BenchVariant& way, const std::vector<Camera>& eyes) {
  FrameInput input{eyes, common};
  input.settings.order = way.order;
  input.settings.composition = compositionOf(way, common);
  input.settings.colourMapping = way.colour;
  input.settings.blend = way.blend;
  return weightedPlans(subject.scene, bounds, input);
}

std::size_t triangleCount(const Scene& scene, const FramePlan& plan) {
  std::size_t count = 0;
  for (const PlannedCell& cell : plan.cells) count += scene.cells[cell.cell].mesh.tier0Count();
  return count;
}

// Triangles over the four corners of the image.
std::vector<glm::vec2> hiddenCorners(const Intrinsics& k) {
  const glm::dvec2 corner(0.5 * k.width / k.fx, 0.5 * k.height / k.fy);  // tangents
  std::vector<glm::vec2> triangles;
  for (const double right : {-1.0, 1.0})
    for (const double up : {-1.0, 1.0}) {
      const glm::dvec2 at = corner * glm::dvec2(right, up);
      const glm::dvec2 inwards = 2 * kHiddenCorner * at;
      for (const glm::dvec2 point : {at, at - glm::dvec2(inwards.x, 0), at - glm::dvec2(0, inwards.y)})
        triangles.emplace_back(point);
    }
  return triangles;
}

RendererOptions rendererOptions(const BenchCase& wanted, VkExtent2D extent) {
  RendererOptions options = optionsFor(wanted.settings, extent);
  options.maxViews = wanted.stereo ? 2 : 1;
  options.orders = {DrawOrder::ours, DrawOrder::paper};
  options.compositions.push_back(Composition::cells);
  if (wanted.settings.blend == BlendMode::blend) options.blends.push_back(BlendMode::dither);
  options.colour = ColourSupport::all;
  return options;
}

bool unmapped(const BenchVariant& way, const BenchVariant& of) {
  return way.order == of.order && way.colour == ColourMapping::off && way.blend == of.blend && way.views == of.views &&
         way.hidden == of.hidden;
}

}  // namespace

Composition compositionOf(const BenchVariant& way, const RenderSettings& settings) {
  return way.order == DrawOrder::paper ? Composition::cells : settings.composition;
}

std::vector<WeightedPlan> weightedPlans(const Scene& scene, const SceneBounds& bounds, FrameInput input) {
  const RenderSettings& settings = input.settings;
  std::vector<WeightedPlan> plans{{planFrame(scene, bounds, input), 1}};
  if (settings.colourMapping != ColourMapping::ours || settings.colourPeriod < 2) return plans;
  input.dtSeconds = 1 / 60.0;
  plans.push_back({planFrame(scene, bounds, input, plans[0].plan.next), 1 - 1.0 / settings.colourPeriod});
  plans[0].weight = 1.0 / settings.colourPeriod;
  return plans;
}

std::vector<Camera> eyesAround(const Camera& middle, double distance) {
  const glm::dvec3 half = middle.pose.rotation * glm::dvec3(0.5 * distance, 0, 0);
  std::vector<Camera> eyes(2, middle);
  eyes[0].pose.position -= half;
  eyes[1].pose.position += half;
  return eyes;
}

struct FrameBench::State {
  State(Device& d, const BenchSubject& s, const BenchCase& wanted)
      : device(d),
        subject(s),
        extent{std::uint32_t(s.views.at(0).intrinsics.width), std::uint32_t(s.views.at(0).intrinsics.height)},
        bounds(sceneBounds(s.scene)),
        gpuScene(d, s.scene, s.gpuScene),
        renderer(d, gpuScene, rendererOptions(wanted, extent)),
        timer(d, 16) {
    if (wanted.stereo) {
      RendererOptions options = rendererOptions(wanted, extent);
      options.hiddenArea.fill(hiddenCorners(s.views[0].intrinsics));
      withHidden.emplace(d, gpuScene, options);
    }
    for (int eye = 0; eye < (wanted.stereo ? 2 : 1); ++eye)
      targets.push_back(pictures.emplace_back(d, extent).target());
  }

  std::vector<ScopeTime> times(const FramePlan& plan, bool hidden) {
    streamAll(device, gpuScene, plan, frame);
    const std::span<const Target> used(targets.data(), plan.views.size());
    pictures[0].render([&](VkCommandBuffer commands) {
      timer.reset(commands);
      const GpuScope scope(commands, &timer, "frame");
      (hidden ? *withHidden : renderer).record(commands, plan, used, &timer);
    });
    const std::vector<ScopeTime> scopes = timer.read();
    check(!scopes.empty(), ErrorCode::unsupported, "{}: the queue has no timestamps", device.name());
    return scopes;
  }

  Device& device;
  const BenchSubject& subject;
  VkExtent2D extent;
  SceneBounds bounds;
  GpuScene gpuScene;
  Renderer renderer;
  std::optional<Renderer> withHidden;
  std::vector<Offscreen> pictures;
  std::vector<Target> targets;
  ScopeTimer timer;
  std::uint64_t frame = 0;  // number of the last frame that streamed
};

FrameBench::FrameBench(Device& device, const BenchSubject& subject, const BenchCase& wanted)
    : state_(std::make_unique<State>(device, subject, wanted)) {}
FrameBench::~FrameBench() = default;

BenchResult FrameBench::measure(const BenchCase& wanted, const std::function<void()>& step) const {
  State& s = *state_;
  BenchResult result;
  for (const BenchVariant& way : variantsOf(wanted)) result.ways.push_back({way, {}, {}, {}, {}, {}, {}});
  const std::size_t count = result.ways.size();
  for (const Camera& view : s.subject.views) {
    std::vector<std::vector<WeightedPlan>> plans;
    for (const VariantTimes& times : result.ways)
      plans.push_back(plansOf(s.subject, s.bounds, wanted.settings, times.way, eyesOf(view, times.way.views)));
    result.drawn = std::max(result.drawn, plans[0][0].plan.cells.size());
    result.triangles = std::max(result.triangles, triangleCount(s.subject.scene, plans[0][0].plan));
    for (int repeat = -1; repeat < wanted.repeat; ++repeat) {  // the first repeat warms up and is not counted
      step();
      std::vector<double> frame(count, 0.0);
      for (std::size_t w = 0; w < count; ++w) {
        std::map<std::string, double> passes;
        for (const WeightedPlan& weighted : plans[w])
          for (const ScopeTime& time : s.times(weighted.plan, result.ways[w].way.hidden))
            (time.depth == 0 ? frame[w] : passes[time.name]) += weighted.weight * time.milliseconds;
        for (const auto& [name, milliseconds] : passes)
          if (repeat >= 0) result.ways[w].passes[name].push_back(milliseconds);
      }
      for (std::size_t w = 0; repeat >= 0 && w < count; ++w) {
        VariantTimes& times = result.ways[w];
        times.milliseconds.push_back(frame[w]);
        for (std::size_t other = 0; other < count; ++other) {
          const BenchVariant& of = result.ways[other].way;
          if (unmapped(of, times.way)) times.ratioToUnmapped.push_back(frame[w] / frame[other]);
          if (of.order == DrawOrder::paper && of.colour == ColourMapping::off && of.views == times.way.views)
            times.ratioToPaper.push_back(frame[w] / frame[other]);
          if (times.way.hidden && !of.hidden && of.order == times.way.order && of.colour == times.way.colour &&
              of.views == times.way.views)
            times.ratioToWithoutMask.push_back(frame[w] / frame[other]);
          if (times.way.views == 2 && of.views == 1 && of.order == times.way.order && of.colour == times.way.colour &&
              of.blend == times.way.blend)
            times.ratioToTwoMono.push_back(frame[w] / (2 * frame[other]));
        }
      }
    }
  }
  return result;
}

}  // namespace ibr::app
