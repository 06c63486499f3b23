// SPDX-License-Identifier: Apache-2.0
// Walks through a generated field of photographs as a viewer does, and measures what each frame costs its thread.
#include <fcntl.h>
#include <fmt/std.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <memory>
#include <nlohmann/json.hpp>
#include <numbers>
#include <thread>

#include "base/check.h"
#include "base/parallel.h"
#include "base/stopwatch.h"
#include "base/usage.h"
#include "batch/command.h"
#include "ibr/frame_plan.h"
#include "ibr/gpu_scene.h"
#include "ibr/offscreen.h"
#include "ibr/renderer.h"
#include "ibr/texture.h"
#include "lab/generate/photograph_field.h"
#include "lab/lab_commands.h"
#include "lab/stream/driver_time.h"
#include "shared/cli/options.h"
#include "shared/cli/progress.h"
#include "shared/cli/settings.h"
#include "shared/report/statistics.h"
#include "shared/report/table.h"

namespace fs = std::filesystem;

namespace ibr::app {
namespace {

constexpr double kMetresPerSecond = 3, kFovY = 0.8;
constexpr int kMaxStandInSide = 64;  // of photographs, px (ibr/gpu_scene.h)
constexpr double kWarmUpSeconds = 1;

struct Options {
  fs::path folder;
  int side = 100, size = 512, fileMs = 0;
  double seconds = 0;
  bool marked = false;
  PictureSize picture{512, 288};
  GpuSceneOptions gpuScene;
  RenderSettings settings;
};

void writeTextures(const Scene& scene, const Context& context) {
  fs::create_directories(scene.folder);
  ProgressLine progress(context);
  const std::size_t count = scene.nodes.size();
  const bool finished = runJobs(
      count, threadsFor(0, 64e6),
      [&](std::size_t node) {
        const fs::path file = scene.folder / scene.nodes[node].textureFile;
        if (!fs::exists(file))
          writeKtx2(file, encodeTexture(buildMips(fieldPhotograph(scene, node)), TextureFormat::bc1));
      },
      [&](std::size_t done) {
        return progress.show({"generating textures", done, count});
      });
  check(finished, ErrorCode::cancelled, "stopped");
}

// The kernel then reads the textures from the disk again.
void dropPageCache(const Scene& scene) {
  for (const Node& node : scene.nodes) {
    const fs::path file = scene.folder / node.textureFile;
    const int opened = open(file.c_str(), O_RDONLY | O_CLOEXEC);
    check(opened >= 0, ErrorCode::io, "{}: cannot be opened", file);
    fdatasync(opened);
    posix_fadvise(opened, 0, 0, POSIX_FADV_DONTNEED);
    close(opened);
  }
}

// Fills a BC1 texture with one colour.
void fill(Texture& texture, std::uint16_t rgb565) {
  const auto low = std::byte(rgb565 & 0xff), high = std::byte(rgb565 >> 8);
  for (std::vector<std::byte>& level : texture.levels)
    for (std::size_t block = 0; block < level.size(); block += 8) {
      std::fill_n(level.begin() + std::ptrdiff_t(block), 8, std::byte(0));
      level[block] = level[block + 2] = low;
      level[block + 1] = level[block + 3] = high;
    }
}

// Reads the textures' files. Marked: stand-ins are red, photographs green, so that a frame shows which it was drawn
// from.
TextureSource sourceOf(const Options& options) {
  return [fileMs = options.fileMs, marked = options.marked](const Scene& scene, std::size_t node, int firstLevel) {
    const bool standIn = scene.nodes[node].camera.intrinsics.width >> firstLevel <= kMaxStandInSide;
    if (!standIn) std::this_thread::sleep_for(std::chrono::milliseconds(fileMs));
    Texture texture = readKtx2(scene.folder / scene.nodes[node].textureFile, firstLevel);
    if (marked) fill(texture, standIn ? 0xf800 : 0x07e0);
    return texture;
  };
}

// Share of red in a picture of marked photographs, of the pixels that show any.
double standInShare(const Image8& picture) {
  double red = 0, all = 0;
  for (std::size_t pixel = 0; pixel < picture.values.size(); pixel += 4) {
    red += picture.values[pixel];
    all += picture.values[pixel] + picture.values[pixel + 1];
  }
  return all > 0 ? red / all : 0;
}

// CPU time of the calling thread since construction.
class CpuTimer {
 public:
  double ownMs() const { return 1e3 * (threadSeconds() - begin_) - driverMs(); }
  double driverMs() const { return 1e3 * (driverSeconds() - driver_); }

 private:
  double begin_ = threadSeconds(), driver_ = driverSeconds();
};

struct Walk {
  std::vector<double> planMs, streamMs, recordMs, ownMs, driverMs, frameMs;  // of every frame
  std::vector<double> standIns, missing;  // shares of pixels and of needed items, after the first second
  std::uint64_t peakBytes = 0, uploadedBytes = 0;
  std::uint32_t failed = 0;
};

double walkSeconds(const Options& options) {
  const double whole = std::numbers::sqrt2 * (options.side - 1) / kMetresPerSecond;
  return options.seconds > 0 ? std::min(options.seconds, whole) : whole;
}

// Along the diagonal of the field, in real time.
Walk walk(const Options& options, const Scene& scene, Device& device, GpuScene& gpuScene, const Context& context) {
  const VkExtent2D extent{std::uint32_t(options.picture.width), std::uint32_t(options.picture.height)};
  const SceneBounds bounds = sceneBounds(scene);
  const Renderer renderer(device, gpuScene, optionsFor(options.settings, extent));
  Offscreen offscreen(device, extent);
  FrameInput input{{{pinholeFromFov(options.picture.width, options.picture.height, kFovY), {}}}, options.settings};
  Walk walk;
  FramePlan plan;
  ProgressLine progress(context);
  dropPageCache(scene);
  const double seconds = walkSeconds(options);
  const Stopwatch stopwatch;
  double before = 0;
  for (std::uint64_t frame = 1;; ++frame) {
    const double now = stopwatch.seconds();
    if (now >= seconds) break;
    check(progress.show({"walking", std::size_t(now * 100), std::size_t(seconds * 100)}), ErrorCode::cancelled,
          "stopped");
    const double along = now * kMetresPerSecond / std::numbers::sqrt2;
    input.views[0].pose.position = {along, 0, along};
    input.dtSeconds = now - before;
    const CpuTimer planning;
    planFrame(scene, bounds, input, plan.next, plan);
    walk.planMs.push_back(planning.ownMs());
    double driverMs = planning.driverMs();
    const Image8 picture = offscreen.render([&](VkCommandBuffer commands) {
      const CpuTimer streaming;
      const GpuScene::StreamStatus streamed = gpuScene.stream(commands, plan, frame, frame - 1);
      walk.streamMs.push_back(streaming.ownMs());
      const CpuTimer recording;
      renderer.record(commands, plan, offscreen.target());
      walk.recordMs.push_back(recording.ownMs());
      driverMs += streaming.driverMs();
      walk.uploadedBytes += streamed.uploadedBytes;
      walk.failed = std::max(walk.failed, streamed.failed);
      if (now >= kWarmUpSeconds)
        walk.missing.push_back(double(streamed.waiting + streamed.overBudget + streamed.failed) /
                               std::max(1u, streamed.needed));
    });
    walk.ownMs.push_back(walk.planMs.back() + walk.streamMs.back() + walk.recordMs.back());
    walk.driverMs.push_back(driverMs);
    walk.frameMs.push_back(1e3 * (stopwatch.seconds() - now));
    walk.peakBytes = std::max(walk.peakBytes, gpuScene.memory().sum());
    if (options.marked && now >= kWarmUpSeconds) walk.standIns.push_back(standInShare(picture));
    before = now;
  }
  return walk;
}

void report(const Options& options, const Scene& scene, const Walk& walk, const Context& context) {
  using Json = nlohmann::ordered_json;
  context.print("field        {} photographs of {} px, {} cells of {} triangles\n", scene.nodes.size(), options.size,
                scene.cells.size(), scene.cells[0].mesh.triangles.size());
  context.print("walk         {} frames in {} s\n", walk.ownMs.size(), numberText(walkSeconds(options), 1));
  Json times;
  context.print("CPU time of the frame's thread, ms   median   99 %   99.9 %\n");
  for (const auto& [name, values] : {std::pair{"planFrame", &walk.planMs},
                                     {"stream", &walk.streamMs},
                                     {"record", &walk.recordMs},
                                     {"all three", &walk.ownMs},
                                     {"driver", &walk.driverMs},
                                     {"whole frame (elapsed)", &walk.frameMs}}) {
    const double median = quantile(*values, 0.5), p99 = quantile(*values, 0.99), p999 = quantile(*values, 0.999);
    context.print("  {:<34} {:>7} {:>7} {:>8}\n", name, numberText(median, 3), numberText(p99, 3), numberText(p999, 3));
    times[name] = {{"median", median}, {"p99", p99}, {"p999", p999}};
  }
  Json standIns;
  if (options.marked) {
    const double most = *std::ranges::max_element(walk.standIns);
    context.print("stand-ins    {} % of the pixels after the first second, at most {} % of a frame's\n",
                  numberText(100 * mean(walk.standIns), 2), numberText(100 * most, 2));
    standIns = {{"mean", mean(walk.standIns)}, {"max", most}};
  }
  const double missing = walk.missing.empty() ? 0 : mean(walk.missing);
  const double mostMissing = walk.missing.empty() ? 0 : *std::ranges::max_element(walk.missing);
  context.print("missing      {} % of the photographs and meshes in view after the first second, at most {} %\n",
                numberText(100 * missing, 2), numberText(100 * mostMissing, 2));
  context.print("memory       {} on the device at most, of a budget of {}; {} of host memory\n",
                bytesText(double(walk.peakBytes)), bytesText(double(options.gpuScene.budgetBytes)),
                bytesText(peakMemory()));
  context.print("uploaded     {}; {} photographs could not be read\n", bytesText(double(walk.uploadedBytes)),
                walk.failed);
  context.report(Json{{"photographs", scene.nodes.size()},
                      {"size", options.size},
                      {"cells", scene.cells.size()},
                      {"frames", walk.ownMs.size()},
                      {"milliseconds", times},
                      {"standInShare", standIns},
                      {"missingShare", {{"mean", missing}, {"max", mostMissing}}},
                      {"peakBytes", walk.peakBytes},
                      {"budget", options.gpuScene.budgetBytes},
                      {"peakHostBytes", peakMemory()},
                      {"uploadedBytes", walk.uploadedBytes},
                      {"failed", walk.failed}});
}

ExitCode measure(const Options& options, const Context& context) {
  measureDriverTime();
  const Scene scene =
      photographField(options.side, options.size, options.folder / fmt::format("{}x{}", options.side, options.size));
  writeTextures(scene, context);
  Device device = Device::create({.device = context.options().device, .log = context.log()});
  GpuSceneOptions gpuSceneOptions = options.gpuScene;
  gpuSceneOptions.log = context.log();
  gpuSceneOptions.source = sourceOf(options);
  GpuScene gpuScene(device, scene, gpuSceneOptions);
  const Walk measured = walk(options, scene, device, gpuScene, context);
  check(!measured.ownMs.empty() && (!options.marked || !measured.standIns.empty()), ErrorCode::invalidInput,
        "the walk is too short");
  report(options, scene, measured, context);
  return kExitOk;
}

}  // namespace

const Command kLabStreamCommand{
    .name = "stream",
    .summary = "Measures planning and streaming in a walk through a large generated scene",
    .examples =
        "ibr-lab stream field --vram-budget 300M\n"
        "ibr-lab stream field --side 32 --size 2048 --vram-budget 500M --marked\n"
        "ibr-lab stream field --vram-budget 300M --marked --file-ms 50",
    .details =
        "The walk follows the diagonal at 3 m/s, in real time. Textures are written into FOLDER once, and\n"
        "the walk begins with an empty page cache. Meshes are generated in memory, one for each cell.\n"
        "CPU times are those of the thread that plans, streams and records; the driver's are apart.",
    .afterInterrupt = "textures that were written are kept; run the same command again",
    .declare = [](CLI::App& app) -> std::function<ExitCode(const Context&)> {
      const auto options = std::make_shared<Options>();
      addOption(app, "FOLDER", options->folder, "Folder of generated textures; created if missing").required();
      addInt(app, "--side", options->side, 2, 1000, "Number of photographs along each side of the field");
      addInt(app, "--size", options->size, 64, 8192, "Width and height of the photographs, px");
      addInt(app, "--file-ms", options->fileMs, 0, 10000, "Time by which each read of a file is delayed, ms");
      addDouble(app, "--seconds", options->seconds, 0, 1e6, "Duration of the walk; 0: to the end of the field");
      addFlag(app, "--marked", options->marked, "Measure the share of pixels that show stand-ins");
      addSize(app, "--picture", options->picture, "Size of the images [512x288]");
      declareGpuScene(app, options->gpuScene);
      declareSettings(app, options->settings);
      return [options](const Context& context) { return measure(*options, context); };
    }};

}  // namespace ibr::app
