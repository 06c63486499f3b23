// SPDX-License-Identifier: Apache-2.0
// `ibr walk`: steadiness and coverage of a walk. Every frame is rendered and compared with the previous one.
//
// A step is the mean absolute difference between neighbouring frames, in 8-bit levels. Motion alone makes steps; a
// switch of the main cell is invisible if its steps are no larger.
#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>
#include <numeric>
#include <optional>

#include "base/check.h"
#include "batch/command.h"
#include "batch/evaluate/union_of_views.h"
#include "batch/evaluate/walk_figures.h"
#include "batch/files/poses.h"
#include "ibr/metrics.h"
#include "ibr/view_scores.h"
#include "io/image_file.h"
#include "shared/camera/auto_path.h"
#include "shared/cli/options.h"
#include "shared/cli/presets.h"
#include "shared/cli/progress.h"
#include "shared/cli/settings.h"
#include "shared/draw/image_operations.h"
#include "shared/draw/scene_renderer.h"

namespace fs = std::filesystem;

namespace ibr::app {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kDifferenceGain = 4;

constexpr std::size_t kHoldPeriod = 10;  // frames between two positions where the camera is held still
constexpr double kHoldStepSeconds = 1.0 / 30;
// Maximum time for plans to settle. Cells that fade out, in and out again do so one after the other, so that fades take
// up to four switchSeconds.
constexpr double kMaxSettleSwitches = 10, kMinSettleSeconds = 1;
constexpr std::size_t kMinHeldFrames = 3, kMaxHeldFrames = 60;  // rendered and compared

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

// The two frames with the largest step.
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
      wanted.maxViews = 2;
      wanted.bufferScene = &scene;
    }
    renderer_.emplace(scene, views, options.gpuScene, wanted, context);
    settings_.alpha = AlphaContent::tier;
  }

  // Renders the i-th frame after the previous one.
  void go(std::size_t i) {
    const double dtSeconds = i > 0 ? frames_[i][0].time - frames_[i - 1][0].time : 0.0;
    std::vector<SceneRenderer::Picture> pictures = renderer_->render(eyesOf(i), settings_, state_, dtSeconds);
    Image8& image = pictures[0].image;
    WalkFrame& frame = measured_.emplace_back();
    frame.name = frames_[i][0].name;
    frame.mainCell = state_.mainCell;
    frame.switching = (i > 0 && measured_[i - 1].mainCell != frame.mainCell) || !state_.previous.empty();
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

  static bool isHeld(std::size_t i) { return i % kHoldPeriod == 0; }

  // Exposure adapts at once: an exponential approach never settles.
  RenderSettings heldSettings() const {
    RenderSettings held = settings_;
    held.exposureSeconds = 0;
    return held;
  }

  struct Rest {
    PlanState state;         // after the plans of a still camera have settled
    double seconds = 0;      // time until the plans settled
    std::size_t period = 0;  // frames after which plans repeat; 1: constant; 0: no repetition found
  };

  // Holds the camera still in plans alone. Compares each state with the previous one and, to find a cycle, with a
  // stored state that is replaced at doubling intervals (Brent 1980). Plans made from equal states are equal.
  Rest settle(std::size_t i) const {
    const FrameInput input{eyesOf(i), heldSettings(), kHoldStepSeconds};
    Rest rest{state_};
    rest.state.framesSinceColourCount = 0;
    PlanState compared = rest.state;
    const double maxSeconds = std::max(kMaxSettleSwitches * settings_.switchSeconds, kMinSettleSeconds);
    for (std::size_t since = 1, limit = 1; rest.seconds <= maxSeconds; ++since) {
      PlanState next = planFrame(scene_, bounds_, input, rest.state).next;
      next.framesSinceColourCount = 0;  // a frame counter, which never settles
      if (next == rest.state)
        rest.period = 1;
      else if (next == compared)
        rest.period = since;
      if (rest.period > 0) return rest;
      rest.state = std::move(next);
      rest.seconds += kHoldStepSeconds;
      if (since == limit) {
        compared = rest.state;
        limit *= 2;
        since = 0;
      }
    }
    return rest;
  }

  // Returns the largest difference between rendered frames of a still camera after its plans have settled. The walk's
  // state is unchanged. Renders one period of the plans, since a frame depends on its plan alone. Colour tables
  // live on the device, so with colour mapping every frame is rendered until the tables have settled too.
  int flickerAt(std::size_t i) {
    const Rest rest = settle(i);
    PlanState state = rest.state;
    std::size_t frames = rest.period > 0 ? std::clamp(rest.period + 1, kMinHeldFrames, kMaxHeldFrames) : kMaxHeldFrames;
    const auto hold = [&] { return renderer_->render(eyesOf(i), heldSettings(), state, kHoldStepSeconds)[0].image; };
    if (settings_.colourMapping != ColourMapping::off) {
      state = state_;
      const double seconds = rest.seconds + settings_.colourFadeSeconds + 8 * settings_.colourSmoothSeconds;
      for (double passed = 0; passed < seconds; passed += kHoldStepSeconds) hold();
      frames = std::max(frames, std::size_t(std::max(settings_.colourPeriod, 0)) + 1);
    }
    const Image8 still = hold();
    int flicker = 0;
    for (std::size_t k = 1; k < frames; ++k) flicker = std::max(flicker, difference(still, hold(), 0).largest);
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
  context.logMessage(LogLevel::info, "settings: {}", presetText(options.settings));
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
  context.report(report);
  return kExitOk;
}

}  // namespace

const Command kWalkCommand{
    .name = "walk",
    .summary = "Measures steadiness and coverage of the frames of a walk",
    .examples =
        "ibr walk scene\n"
        "ibr walk scene --frames 600 --size 640x360 -o worst\n"
        "ibr walk scene --poses path.json --json walk.json\n"
        "ibr walk scene --frames 60 --size 640x360 --pop --stereo --ipd 0.063",
    .details =
        "A step is the mean absolute difference between neighbouring frames, in 8-bit levels. A\n"
        "switch lasts until the cross-fade of two draw orders is over. The coverage by\n"
        "photographs counts pixels whose rays lie in the image of one photograph, from a near\n"
        "distance to infinity. A tenth of the scene's points are nearer than the near distance.\n"
        "At every tenth frame, the camera is also held still until all fades end. Frames that\n"
        "still differ then flicker, and the worst position is reported. -o writes the two frames\n"
        "of the largest step, and four times their difference. --pop also reports steps as FLIP;\n"
        "the largest FLIP at a switch is the pop. --stereo compares the images of both eyes at\n"
        "the same depth.",
    .afterInterrupt = "no report was written; run the same command again",
    .mainOptions = "frames poses output pop stereo size preset json",
    .declare = [](CLI::App& app) -> std::function<ExitCode(const Context&)> {
      const auto options = std::make_shared<Options>();
      addOption(app, "SCENE", options->scene, "Scene folder").required();
      const Option frames =
          addInt(app, "--frames", options->autoFrames, 2, 1'000'000,
                 "Number of frames of an automatic walk between and slightly beyond the photographs, 30 per "
                 "second");
      addOption(app, "--poses", options->poses, "Camera path to follow").type("FILE").excludes(frames);
      addOption(app, "-o,--output", options->output, "Folder for the image of the largest step").type("DIR");
      addFlag(app, "--pop", options->pop, "Also report steps as FLIP; takes about as long as drawing");
      const Option stereo = addFlag(app, "--stereo", options->stereo, "Render two eyes and measure their agreement");
      addDouble(app, "--ipd", options->ipd, 1e-9, 1e9, "Distance between the eyes, world units").needs(stereo);
      addSize(app, "--size", options->size, "Size of the images [that of the path; else of the photographs]");
      declareSettings(app, options->settings);
      declareGpuScene(app, options->gpuScene);
      return [options](const Context& context) { return walk(*options, context); };
    }};

}  // namespace ibr::app
