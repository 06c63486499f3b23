// SPDX-License-Identifier: Apache-2.0
// How steady and how whole a walk is: every frame is rendered and compared with the one before it.
//
// A step is the mean absolute difference between neighbouring frames, in levels. Motion alone makes steps; a switch of
// the main cell that cannot be seen makes none larger than they are.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>
#include <numeric>
#include <optional>

#include "base/check.h"
#include "batch/command.h"
#include "batch/poses.h"
#include "batch/union_of_views.h"
#include "batch/walk_figures.h"
#include "ibr/metrics.h"
#include "io/image_file.h"
#include "shared/auto_path.h"
#include "shared/options.h"
#include "shared/pictures.h"
#include "shared/progress.h"
#include "shared/scene_renderer.h"
#include "shared/settings.h"

namespace fs = std::filesystem;

namespace ibr::app {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kDifferenceGain = 4;

constexpr int kHolds = 4;       // places of a walk where the camera is held still …
constexpr int kHeldFrames = 3;  // … for so many frames after all mixtures and fades are over

struct Options {
  std::string scene, poses, output;
  int autoFrames = 300;
  PictureSize size;
  RenderSettings settings;
  GpuSceneOptions gpuScene;
  bool pop = false, stereo = false;
  double ipd = 0;
};

void measureTiers(const Image8& image, const UnionOfViews& photographs, const Camera& camera, WalkFrame& frame) {
  frame.tier = tierShares(image);
  frame.coverage = std::accumulate(frame.tier.begin(), frame.tier.end(), 0.0);
  std::size_t inside = 0, covered = 0;
  for (const glm::ivec2 pixel : photographs.pixelsSeen(camera)) {
    ++inside;
    covered += image.values[4 * (std::size_t(pixel.y) * std::size_t(image.width) + std::size_t(pixel.x)) + 3] > 0;
  }
  if (inside > 0) frame.coverageInside = double(covered) / double(inside);
}

// The two frames of the largest step.
struct WorstStep {
  double step = -1;
  Image8 before, after;
};

class Walk {
 public:
  Walk(const Options& options, const Scene& scene, const std::vector<Frame>& frames, const Context& context)
      : options_(options),
        scene_(scene),
        bounds_(sceneBounds(scene)),
        frames_(frames),
        photographs_(scene),
        settings_(options.settings) {
    std::vector<View> views;
    for (const Frame& frame : frames) views.insert(views.end(), frame.begin(), frame.end());
    RendererOptions wanted = optionsFor(settings_, {});
    if (options.stereo) {
      wanted.views = 2;
      wanted.buffers = &scene;
    }
    renderer_.emplace(scene, views, options.gpuScene, wanted, context);
    settings_.alpha = AlphaContent::tier;
  }

  // To the i-th frame, after the one before.
  void go(std::size_t i) {
    const double dtSeconds = i > 0 ? frames_[i][0].time - frames_[i - 1][0].time : 0.0;
    std::vector<SceneRenderer::Picture> pictures = renderer_->render(eyesOf(i), settings_, state_, dtSeconds);
    Image8& image = pictures[0].image;
    WalkFrame& frame = measured_.emplace_back();
    frame.name = frames_[i][0].name;
    frame.mainCell = state_.mainCell;
    frame.switching = (i > 0 && measured_[i - 1].mainCell != frame.mainCell) || !state_.former.empty();
    measureTiers(image, photographs_, frames_[i][0].camera, frame);
    if (i > 0) frame.step = difference(image, before_, 0).meanAbsolute;
    if (i > 0 && options_.pop) frame.flipStep = flip(image, before_);
    if (options_.stereo)
      frame.eyes = eyeAgreement(pictures[0], frames_[i][0].camera, pictures[1], frames_[i][1].camera);
    if (isHeld(i)) frame.flicker = flickerAt(i);
    if (frame.step > worst_.step) worst_ = {frame.step, before_, image};
    before_ = std::move(image);
  }

  const std::vector<WalkFrame>& measured() const { return measured_; }
  const WorstStep& worst() const { return worst_; }
  const RenderSettings& settings() const { return settings_; }
  std::string deviceName() const { return renderer_->deviceName(); }

 private:
  std::vector<Camera> eyesOf(std::size_t i) const {
    std::vector<Camera> eyes;
    for (const View& view : frames_[i]) eyes.push_back(view.camera);
    return eyes;
  }

  bool isHeld(std::size_t i) const {
    const std::size_t apart = std::max<std::size_t>(frames_.size() / kHolds, 1);
    return i % apart == apart / 2;
  }

  // How long what changes by itself goes on, seconds: mixtures and fades, an eye that adapts, colour tables.
  double restlessSeconds() const {
    double seconds = settings_.switchSeconds;
    const bool adapts =
        settings_.exposure == Exposure::adapted &&
        std::ranges::any_of(scene_.nodes, [](const Node& node) { return node.gain != glm::dvec3(1.0); });
    if (adapts) seconds = std::max(seconds, 8 * settings_.exposureSeconds);
    if (settings_.colourMapping != ColourMapping::off)
      seconds = std::max(seconds, settings_.colourFadeSeconds + 8 * settings_.colourSmoothSeconds);
    return seconds;
  }

  // The walk itself goes on as if nobody had stood still. Colour tables live on the device, so there they take frames;
  // without them time passes in the plans alone.
  int flickerAt(std::size_t i) {
    constexpr double kLongestStep = 0.1;  // FrameInput::dtSeconds
    PlanState state = state_;
    const auto hold = [&](double seconds) { return renderer_->render(eyesOf(i), settings_, state, seconds)[0].image; };
    for (double passed = 0; passed <= restlessSeconds(); passed += kLongestStep) {
      if (settings_.colourMapping != ColourMapping::off)
        hold(kLongestStep);
      else
        state = planFrame(scene_, bounds_, {eyesOf(i), settings_, kLongestStep}, state).next;
    }
    const Image8 still = hold(kLongestStep);
    int flicker = 0;
    for (int k = 0; k < kHeldFrames; ++k) flicker = std::max(flicker, difference(still, hold(1.0 / 30), 0).largest);
    return flicker;
  }

  const Options& options_;
  const Scene& scene_;
  SceneBounds bounds_;
  const std::vector<Frame>& frames_;
  UnionOfViews photographs_;
  RenderSettings settings_;
  std::optional<SceneRenderer> renderer_;
  PlanState state_;
  std::vector<WalkFrame> measured_;
  Image8 before_;
  WorstStep worst_;
};

ExitCode walk(const Options& options, const Context& context) {
  const Scene scene = loadScene(options.scene);
  const std::vector<View> views =
      options.poses.empty() ? frames(autoPath(scene, options.autoFrames, options.size.width, options.size.height))
                            : readViews(options.poses, options.size, context.log(), options.stereo);
  const std::vector<Frame> frames = framesOf(views, options.stereo, options.ipd);
  Walk walk(options, scene, frames, context);
  {
    ProgressLine progress(context);
    for (std::size_t i = 0; i < frames.size(); ++i) {
      check(progress.show({"walking", i, frames.size()}), ErrorCode::cancelled, "stopped");
      walk.go(i);
    }
    progress.show({"walking", frames.size(), frames.size()});
  }
  if (!options.output.empty() && walk.worst().step >= 0) {
    fs::create_directories(options.output);
    const Image8 a = rgb(walk.worst().before), b = rgb(walk.worst().after);
    writeImage(fs::path(options.output) / "largest_step.png",
               sideBySide({a, b, absoluteDifference(a, b, kDifferenceGain)}));
  }
  const WalkSummary summary = summaryOf(walk.measured());
  context.print("{}", summaryTable(summary, frames.size()).text());
  Json report{{"frames", Json::array()}};
  for (const WalkFrame& frame : walk.measured()) report["frames"].push_back(frameJson(frame));
  report.update(summaryJson(summary));
  report["device"] = walk.deviceName();
  report["settings"] = settingsJson(walk.settings(), options.gpuScene);
  report["scene"] = options.scene;
  context.report(report.dump(2, ' ', false, Json::error_handler_t::replace));
  return kExitOk;
}

}  // namespace

const Command kWalkCommand{
    .name = "walk",
    .summary = "Measures how steady and how whole the pictures of a walk are",
    .examples =
        "ibr walk scene\n"
        "ibr walk scene --frames 600 --size 640x360 -o worst\n"
        "ibr walk scene --poses path.json --json walk.json\n"
        "ibr walk scene --frames 60 --size 640x360 --pop --stereo --ipd 0.063",
    .details =
        "A step is the mean absolute difference between neighbouring frames, in levels of 255. A switch lasts until "
        "the\n"
        "mixture of the two orders of cells is over. What photographs see: pixels whose rays lie in the picture of "
        "one\n"
        "photograph from a near distance (a tenth of the scene's points are nearer) to infinity. -o writes the two\n"
        "frames of the largest step, and four times their difference. At four places the camera is also held still "
        "until\n"
        "nothing fades any more: pictures that differ after that flicker. --pop also tells steps as FLIP, of which "
        "the\n"
        "largest at a switch is the pop. --stereo compares what both eyes see at the same depth.",
    .afterInterrupt = "Nothing was reported; run the same command again.",
    .declare = [](CLI::App& app) -> std::function<ExitCode(const Context&)> {
      const auto options = std::make_shared<Options>();
      app.add_option("SCENE", options->scene, "Scene folder")->required();
      auto* frames = addInt(app, "--frames", options->autoFrames, 2, 1'000'000,
                            "Frames of an automatic walk between and slightly beyond the photographs, 30 a second");
      app.add_option("--poses", options->poses, "Camera path to walk")->type_name("FILE")->excludes(frames);
      app.add_option("-o,--output", options->output, "Folder for the picture of the largest step")->type_name("DIR");
      app.add_flag("--pop", options->pop, "Also steps as FLIP, which takes about as long as drawing");
      auto* stereo = app.add_flag("--stereo", options->stereo, "Two eyes, and how far they agree");
      addDouble(app, "--ipd", options->ipd, 1e-9, 1e9, "Distance of the eyes in world units")->needs(stereo);
      addSize(app, "--size", options->size, "Size of the pictures [that of the path; else of the photographs]");
      declareSettings(app, options->settings);
      declareGpuScene(app, options->gpuScene);
      return [options](const Context& context) { return walk(*options, context); };
    }};

}  // namespace ibr::app
