// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <chrono>
#include <nlohmann/json.hpp>

#include "base/check.h"
#include "batch/bench/bench_photographs.h"
#include "ibr/offscreen.h"
#include "shared/cli/progress.h"
#include "shared/draw/scene_renderer.h"
#include "shared/report/statistics.h"
#include "shared/report/table.h"

namespace ibr::app {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::uint64_t kFramesInFlight = 2;

// Share of the pixels with alpha 0, where nothing was drawn.
double emptyShare(const Image8& picture) {
  std::size_t empty = 0;
  for (std::size_t i = 3; i < picture.values.size(); i += 4) empty += picture.values[i] == 0;
  return double(empty) / (double(picture.width) * picture.height);
}

struct Walk {
  GpuScene::Memory peak;
  std::uint64_t uploadedBytes = 0, maxUploadedBytes = 0;  // in total, and maximum of a frame
  std::size_t framesWithStandIns = 0, framesWithHoles = 0;
  std::vector<double> standIns, empty, streamMs, frameMs;  // of every frame: shares, ms
  std::uint32_t failed = 0;                                // photographs, maximum of a frame
};

Walk measureWalk(const PhotographBench& bench, Device& device, GpuScene& gpuScene, const Context& context) {
  using Clock = std::chrono::steady_clock;
  const auto milliseconds = [](Clock::time_point begin) {
    return std::chrono::duration<double, std::milli>(Clock::now() - begin).count();
  };
  const Intrinsics& size = bench.views[0].camera.intrinsics;
  const VkExtent2D extent{std::uint32_t(size.width), std::uint32_t(size.height)};
  const SceneBounds bounds = sceneBounds(bench.scene);
  const Renderer renderer(device, gpuScene, optionsFor(bench.settings, extent));
  Offscreen offscreen(device, extent);
  RenderSettings settings = bench.settings;
  settings.alpha = AlphaContent::tier;
  Walk walk;
  PlanState state;
  ProgressLine progress(context);
  for (std::size_t v = 0; v < bench.views.size(); ++v) {
    check(progress.show({"walking", v, bench.views.size()}), ErrorCode::cancelled, "stopped");
    const auto begin = Clock::now();
    const double dtSeconds = v > 0 ? bench.views[v].time - bench.views[v - 1].time : 0;
    const FramePlan plan = planFrame(bench.scene, bounds, {{bench.views[v].camera}, settings, dtSeconds}, state);
    state = plan.next;
    GpuScene::StreamStatus streamed;
    const std::uint64_t frame = v + 1;
    const Image8 picture = offscreen.render([&](VkCommandBuffer commands) {
      const auto beginStream = Clock::now();
      streamed = gpuScene.stream(commands, plan, frame, frame > kFramesInFlight ? frame - kFramesInFlight : 0);
      walk.streamMs.push_back(milliseconds(beginStream));
      renderer.record(commands, plan, offscreen.target());
    });
    walk.frameMs.push_back(milliseconds(begin));
    walk.empty.push_back(emptyShare(picture));
    const std::uint32_t standIns = streamed.waiting + streamed.overBudget + streamed.failed;
    walk.standIns.push_back(streamed.needed > 0 ? double(standIns) / streamed.needed : 0);
    walk.framesWithStandIns += standIns > 0;
    walk.framesWithHoles += walk.empty.back() > 0;
    walk.uploadedBytes += streamed.uploadedBytes;
    walk.maxUploadedBytes = std::max(walk.maxUploadedBytes, streamed.uploadedBytes);
    walk.failed = std::max(walk.failed, streamed.failed);
    if (const GpuScene::Memory memory = gpuScene.memory(); memory.sum() > walk.peak.sum()) walk.peak = memory;
  }
  progress.show({"walking", bench.views.size(), bench.views.size()});
  return walk;
}

}  // namespace

Json benchWalk(const PhotographBench& bench, const Context& context) {
  Device device = Device::create({.device = context.options().device, .log = context.log()});
  GpuScene gpuScene(device, bench.scene, batchOptions(bench.gpuScene, context));
  Walk walk = measureWalk(bench, device, gpuScene, context);
  const std::size_t frames = bench.views.size();
  const std::uint64_t budget = bench.gpuScene.budgetBytes;
  context.print("frames       {}; the scene has {} photographs and {} cells\n", frames, bench.scene.nodes.size(),
                bench.scene.cells.size());
  context.print("memory       maximum {}: photographs {}, vertices {}, indices {}{}\n",
                bytesText(double(walk.peak.sum())), bytesText(double(walk.peak.textures)),
                bytesText(double(walk.peak.positions)), bytesText(double(walk.peak.indices)),
                budget > 0 ? fmt::format("; budget {}", bytesText(double(budget))) : "");
  context.print("streamed     {}, at most {} in a frame\n", bytesText(double(walk.uploadedBytes)),
                bytesText(double(walk.maxUploadedBytes)));
  context.print("stand-ins    in {} frames; {} % of the photographs and meshes that frames need\n",
                walk.framesWithStandIns, numberText(100 * mean(walk.standIns), 2));
  context.print("holes        in {} frames; at most {} % of an image\n", walk.framesWithHoles,
                numberText(100 * *std::ranges::max_element(walk.empty), 3));
  context.print("frame time   median {} ms, of which streaming {} ms; 95 % quantiles {} ms and {} ms\n",
                numberText(quantile(walk.frameMs, 0.5), 1), numberText(quantile(walk.streamMs, 0.5), 2),
                numberText(quantile(walk.frameMs, 0.95), 1), numberText(quantile(walk.streamMs, 0.95), 2));
  return {{"device", device.name()},
          {"walk",
           {{"frames", frames},
            {"photographs", bench.scene.nodes.size()},
            {"budget", budget > 0 ? Json(budget) : Json()},
            {"peak",
             {{"positions", walk.peak.positions}, {"indices", walk.peak.indices}, {"textures", walk.peak.textures}}},
            {"streamedBytes", walk.uploadedBytes},
            {"maxStreamedBytes", walk.maxUploadedBytes},
            {"framesWithStandIns", walk.framesWithStandIns},
            {"standInShare", mean(walk.standIns)},
            {"framesWithHoles", walk.framesWithHoles},
            {"maxHoleShare", *std::ranges::max_element(walk.empty)},
            {"failed", walk.failed},
            {"medianMs", quantile(walk.frameMs, 0.5)},
            {"p95Ms", quantile(walk.frameMs, 0.95)},
            {"streamMedianMs", quantile(walk.streamMs, 0.5)},
            {"streamP95Ms", quantile(walk.streamMs, 0.95)}}}};
}

}  // namespace ibr::app
