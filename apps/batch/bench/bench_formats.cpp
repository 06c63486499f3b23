// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>

#include "base/check.h"
#include "batch/bench/bench_photographs.h"
#include "batch/files/reencode_textures.h"
#include "ibr/metrics.h"
#include "ibr/offscreen.h"
#include "ibr/scope_timer.h"
#include "shared/cli/progress.h"
#include "shared/draw/scene_renderer.h"
#include "shared/report/statistics.h"
#include "shared/report/table.h"

namespace ibr::app {
namespace {

using Json = nlohmann::ordered_json;

struct FormatVariant {
  TextureFormat format;
  TextureFilter filter;
  const char* filterName;
};
constexpr FormatVariant kVariants[]{
    {TextureFormat::rgba8, TextureFilter::trilinear, "trilinear"},
    {TextureFormat::rgba8, TextureFilter::bilinear, "bilinear"},
    {TextureFormat::bc7, TextureFilter::trilinear, "trilinear"},
    {TextureFormat::bc7, TextureFilter::bilinear, "bilinear"},
    {TextureFormat::bc1, TextureFilter::trilinear, "trilinear"},
    {TextureFormat::bc1, TextureFilter::bilinear, "bilinear"},
    {TextureFormat::rgba8, TextureFilter::bicubic, "bicubic"},
};

struct Measured {
  std::unique_ptr<GpuScene> gpuScene;
  std::unique_ptr<Renderer> renderer;
  std::vector<double> milliseconds, ratios, psnrs;  // ratios and psnrs: to the first variant
};

}  // namespace

Json benchFormats(const PhotographBench& bench, const Context& context) {
  Device device = Device::create({.device = context.options().device, .log = context.log()});
  check(device.supportsBlockCompression(), ErrorCode::unsupported,
        "{}: the device does not support block-compressed textures", device.name());
  const Intrinsics& size = bench.views[0].camera.intrinsics;
  const VkExtent2D extent{std::uint32_t(size.width), std::uint32_t(size.height)};
  const SceneBounds bounds = sceneBounds(bench.scene);
  Offscreen offscreen(device, extent);
  ScopeTimer timer(device, 1);
  ProgressLine progress(context);
  const std::size_t steps = std::size(kVariants) + bench.views.size();
  std::vector<Measured> variants;
  for (const FormatVariant& variant : kVariants) {
    check(progress.show({"encoding", variants.size(), steps}), ErrorCode::cancelled, "stopped");
    GpuSceneOptions options = batchOptions(bench.gpuScene, context);
    options.source = encodedAs(variant.format);
    options.blocks = BlockTextureMode::keep;
    options.filter = variant.filter;
    Measured& measured = variants.emplace_back();
    measured.gpuScene = std::make_unique<GpuScene>(device, bench.scene, options);
    measured.renderer = std::make_unique<Renderer>(device, *measured.gpuScene, optionsFor(bench.settings, extent));
  }
  for (std::size_t v = 0; v < bench.views.size(); ++v) {
    const FramePlan plan = planFrame(bench.scene, bounds, {{bench.views[v].camera}, bench.settings});
    for (int repeat = -1; repeat < bench.repeat; ++repeat) {  // the first repeat warms up and is not counted
      check(progress.show({"measuring", std::size(kVariants) + v, steps}), ErrorCode::cancelled, "stopped");
      double first = 0;
      Image8 expected;
      for (Measured& variant : variants) {
        const Image8 picture = offscreen.render([&](VkCommandBuffer commands) {
          timer.reset(commands);
          const GpuScope scope(commands, &timer, "frame");
          variant.renderer->record(commands, plan, offscreen.target());
        });
        const std::vector<ScopeTime> times = timer.read();
        check(!times.empty(), ErrorCode::unsupported, "{}: the queue has no timestamps", device.name());
        if (&variant == &variants[0]) {
          first = times[0].milliseconds;
          expected = picture;
        }
        if (repeat < 0) {
          variant.psnrs.push_back(psnr(picture, expected));
        } else {
          variant.milliseconds.push_back(times[0].milliseconds);
          variant.ratios.push_back(times[0].milliseconds / first);
        }
      }
    }
  }
  progress.show({"measuring", steps, steps});

  Table table;
  table.row({"textures", "filter", "memory", "median ms", "p95 ms", "ratio", "PSNR dB"});
  Json list = Json::array();
  for (std::size_t w = 0; w < variants.size(); ++w) {
    const Measured& variant = variants[w];
    const std::uint64_t bytes = variant.gpuScene->memory().textures;
    const double quality = w == 0 ? NAN : mean(variant.psnrs);
    table.row({textureFormatName(kVariants[w].format), kVariants[w].filterName, bytesText(double(bytes)),
               numberText(quantile(variant.milliseconds, 0.5), 1), numberText(quantile(variant.milliseconds, 0.95), 1),
               numberText(quantile(variant.ratios, 0.5), 3), numberText(quality, 1)});
    list.push_back({{"texture", textureFormatName(kVariants[w].format)},
                    {"filter", kVariants[w].filterName},
                    {"textureBytes", bytes},
                    {"medianMs", quantile(variant.milliseconds, 0.5)},
                    {"p95Ms", quantile(variant.milliseconds, 0.95)},
                    {"n", variant.milliseconds.size()},
                    {"ratio", quantile(variant.ratios, 0.5)},
                    {"psnr", w == 0 ? Json() : Json(quality)}});
  }
  context.print("{}", table.text());
  return {{"device", device.name()}, {"formats", list}};
}

}  // namespace ibr::app
