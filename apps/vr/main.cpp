// SPDX-License-Identifier: Apache-2.0
// The program `ibr-vr`: shows photographs in a headset.
#include <chrono>
#include <cstdlib>
#include <memory>
#include <nlohmann/json.hpp>
#include <numbers>
#include <thread>
#include <utility>

#include "base/check.h"
#include "ibr/version.h"
#include "shared/cli/exit_code.h"
#include "shared/cli/folders.h"
#include "shared/cli/options.h"
#include "shared/cli/presets.h"
#include "shared/cli/settings.h"
#include "shared/cli/signals.h"
#include "vr/show/vr_app.h"

namespace fs = std::filesystem;

namespace ibr::app {
namespace {

constexpr const char* kName = "ibr-vr";
constexpr int kMaxLosses = 3;                          // consecutive losses of a headset …
constexpr std::chrono::seconds kQuickLossLimit{10};    // … each less than this after the start
constexpr std::chrono::seconds kReconnectTimeout{60};  // time to wait for a lost headset

struct Options {
  CommonOptions common;
  VrOptions vr;
  std::vector<std::string> places;
  std::string screenshot, screenshots = picturesFolder().string(), log, space = "auto";
  double snapDegrees = 30;
  int frames = 0, screenshotEvery = 0;
  bool noFloor = false, noGovernor = false, noMirror = false, forget = false;
};

void declareComfort(CLI::App& app, Options& o) {
  addOption(app, "--space", o.space,
            "Tracking space: the room as set up (stage), or around the start position of the "
            "head (local) [auto]")
      .oneOf({"auto", "stage", "local"});
  addDouble(app, "--eye-height", o.vr.eyeHeight, 0.1, 10,
            "Height of the eyes at the start if the room is not known, m");
  addParsed(
      app, "--scale", [&o](const std::string& text) { o.vr.unitsPerMetre = parsedDouble("--scale", text, 1e-6, 1e6); },
      "World units per metre; the menu changes this scale [last value, else 1]")
      .type("X");
  addDouble(app, "--photograph-height", o.vr.walk.photographHeightMetres, 0, 1000,
            "Height of the photographs above the ground, m");
  addDouble(app, "--snap-turn", o.snapDegrees, 0, 180,
            "Angle of a turn by the stick, degrees; 0: the stick does not "
            "turn");
  addFlag(app, "--smooth-motion", o.vr.walk.smoothMotion, "Move continuously with the left stick, with a vignette");
  addFlag(app, "--no-floor", o.noFloor, "Draw no guiding grid on the floor");
}

void declareOptions(CLI::App& app, Options& o) {
  addOption(app, "SCENE", o.places, "Scenes to show; the map switches between scenes").required();
  addInt(app, "--frames", o.frames, 0, 1000000000,
         "Number of frames of a scene after which the program exits; 0: exit "
         "when the user leaves");
  addOption(app, "--log", o.log, "Log of every frame, one line of JSON per frame").type("FILE");
  addOption(app, "--screenshot", o.screenshot, "Last images of both eyes, FILE_l.png and FILE_r.png; requires --frames")
      .type("FILE.png");
  addOption(app, "--screenshots", o.screenshots, fmt::format("Folder for screenshots [{}]", o.screenshots)).type("DIR");
  addFlag(app, "--no-mirror", o.noMirror, "Open no window that mirrors the left eye");
  addFlag(app, "--no-governor", o.noGovernor, "Draw all requested detail, even if frames are missed");
  addFlag(app, "--forget", o.forget, "Neither load nor save state between runs, such as scales and pipelines");
  addFlag(app, "--validation", o.vr.validation, "Report errors found by Vulkan's validation layers");
  addInt(app, "--screenshot-every", o.screenshotEvery, 0, 1000000000,
         "Write a screenshot of every N-th frame; frames wait until the previous ones are written. 0: none")
      .group("");  // for tests
  inGroup(app, "Comfort", [&] { declareComfort(app, o); });
  inGroup(app, "Scenes", [&] {
    declareSettings(app, o.vr.settings);
    declareOverlays(app, o.vr.settings);
    declareGpuScene(app, o.vr.gpuScene);
  });
  declareCommonOptions(app, o.common);
}

void take(Options& o) {
  o.vr.places.assign(o.places.begin(), o.places.end());
  o.vr.screenshot = o.screenshot;
  o.vr.screenshots = o.screenshots;
  o.vr.screenshotEvery = std::uint64_t(o.screenshotEvery);
  o.vr.frames = std::uint64_t(o.frames);
  o.vr.walk.snapTurn = o.snapDegrees * std::numbers::pi / 180;
  if (o.space != "auto") o.vr.space = o.space == "stage" ? SpaceKind::stage : SpaceKind::local;
  o.vr.floor = !o.noFloor;
  o.vr.governorEnabled = !o.noGovernor;
  o.vr.mirror = !o.noMirror;
  if (const fs::path cache = o.forget ? fs::path() : cacheFolder(); !cache.empty())
    o.vr.pipelineCache = cache / "vr-pipelines.bin";
}

bool isRecoverable(ErrorCode code) {
  return code == ErrorCode::deviceLost || code == ErrorCode::unsupported;  // the latter: no runtime, no headset
}

// A runtime that was lost may need a while to come back.
std::unique_ptr<VrApp> makeVrApp(VrState& state) {
  using Clock = std::chrono::steady_clock;
  const Clock::time_point begun = Clock::now();
  for (bool told = false;;) try {
      return std::make_unique<VrApp>(state);
    } catch (const Error& e) {
      const bool waits = state.losses > 0 && isRecoverable(e.code()) && Clock::now() - begun < kReconnectTimeout;
      if (!waits || interrupted() || (state.window && state.window->closing())) throw;
      if (!std::exchange(told, true))
        state.context.logMessage(LogLevel::warning, "waiting for the headset: {}", e.what());
      std::this_thread::sleep_for(std::chrono::seconds(1));
      if (state.window) state.window->handleEvents(0);
    }
}

// Restarts after losses of headset, runtime or device. Gives up after more than kMaxLosses losses in a row.
void runUntilExit(VrState& state) {
  using Clock = std::chrono::steady_clock;
  for (int losses = 0;;) {
    const std::unique_ptr<VrApp> app = makeVrApp(state);
    const Clock::time_point begun = Clock::now();
    try {
      return app->run();
    } catch (const Error& e) {
      if (e.code() != ErrorCode::deviceLost) throw;
      if (state.leaving) return;
      losses = Clock::now() - begun < kQuickLossLimit ? losses + 1 : 1;
      if (losses > kMaxLosses) throw;
      ++state.losses;
      state.context.logMessage(LogLevel::warning, "the headset was lost; the session restarts: {}", e.what());
    }
  }
}

// Returns nullptr without a display: the mirror is optional.
std::unique_ptr<Window> mirrorWindow(const Context& context) try {
  if (!std::getenv("DISPLAY") && !std::getenv("WAYLAND_DISPLAY")) return nullptr;
  return std::make_unique<Window>("ibr-vr", 800, 600);
} catch (const Error& e) {
  context.logMessage(LogLevel::warning, "no mirror window: {}", e.what());
  return nullptr;
}

double unitsPerMetre(const VrState& state) {
  return state.walk ? state.walk->tracking.unitsPerMetre : state.initialScale(state.current);
}

nlohmann::ordered_json report(const VrState& state, const nlohmann::ordered_json& summary) {
  using Json = nlohmann::ordered_json;
  Json pictures = Json::array();
  for (const fs::path& file : state.pictures) pictures.push_back(file.string());
  return Json{{"headset", state.headset},
              {"eyes", state.eyes},
              {"scene", state.options.places[state.current].string()},
              {"unitsPerMetre", unitsPerMetre(state)},
              {"losses", state.losses},
              {"frames", summary},
              {"pictures", std::move(pictures)}};
}

ExitCode show(SceneReading& reading, int argc, char** argv) {
  Options o;
  o.common.program = kName;
  const ProgramText program{kName, std::string(version()),
                            "Examples:\n"
                            "  ibr-vr scene\n"
                            "  ibr-vr hall garden --preset fast --scale 0.37\n"
                            "  ibr-vr scene --frames 900 --log frames.jsonl --screenshot eyes.png\n\n"
                            "Shows scenes in a headset by OpenXR. Hold the trigger to point at a capture site.\n"
                            "Release the trigger to move there. The stick turns. The menu button (Y or B) shows a map\n"
                            "and settings.\n"};
  const auto declare = [&](CLI::App& app) { declareOptions(app, o); };
  const auto ends = parseCommandLine(program, argc, argv, declare, [&] {
    if (!o.common.device.empty()) refuseOption("--device", "the OpenXR runtime chooses the device");
    if (!o.screenshot.empty() && o.frames == 0) refuseOptions("--screenshot requires --frames");
  });
  if (ends) return *ends;
  take(o);
  const Context context(o.common);
  watchForInterrupt();
  context.logMessage(LogLevel::info, "settings: {}", presetText(o.vr.settings));
  FrameLog log(o.log);
  const fs::path settings = o.forget ? fs::path() : settingsFolder();
  ScaleCache scales(settings.empty() ? fs::path() : settings / "scales.json", context.log());
  VrState state{.options = o.vr, .context = context, .log = log, .scales = scales, .reading = reading};
  state.files.resize(o.vr.places.size());
  state.walking = o.vr.walk;
  state.eyeHeight = o.vr.eyeHeight;
  state.governorEnabled = o.vr.governorEnabled;
  state.composition = o.vr.settings.composition;
  const std::unique_ptr<Window> window = o.vr.mirror ? mirrorWindow(context) : nullptr;
  state.window = window.get();
  try {
    runUntilExit(state);
  } catch (...) {
    log.finish();
    throw;
  }
  check(state.validationMessages == 0, ErrorCode::vulkan, "Vulkan's validation layers reported {} messages",
        state.validationMessages.load());
  if (state.saveScale())
    context.logMessage(LogLevel::info, "the scale is now --scale {:.4g}, saved for the next run", unitsPerMetre(state));
  context.report(report(state, log.finish()));
  log.check();
  return interrupted() ? kExitInterrupted : kExitOk;
}

}  // namespace
}  // namespace ibr::app

// A scene that is still being read is not waited for: a stopped thread frees its document value by value, which takes
// about a second for a hundred megabytes.
int main(int argc, char** argv) {
  using namespace ibr::app;
  SceneReading reading;
  const ExitCode code = guarded(kName, [&] { return show(reading, argc, argv); });
  reading.requestStop();
  if (reading.isRunning()) exitWithoutWaiting(code);
  return code;
}
