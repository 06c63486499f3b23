// SPDX-License-Identifier: Apache-2.0
// The program `ibr-viewer`: explores photographs in a window.
#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "base/check.h"
#include "base/file.h"
#include "ibr/error.h"
#include "ibr/version.h"
#include "shared/cli/context.h"
#include "shared/cli/exit_code.h"
#include "shared/cli/folders.h"
#include "shared/cli/options.h"
#include "shared/cli/presets.h"
#include "shared/cli/settings.h"
#include "shared/report/statistics.h"
#include "viewer/control/screenshot.h"
#include "viewer/viewer_session.h"

namespace fs = std::filesystem;

namespace ibr::app {
namespace {

constexpr const char* kName = "ibr-viewer";

struct Options {
  CommonOptions common;
  SessionOptions session;
  std::vector<std::string> places;
  PictureSize size{1280, 720};
  std::string screenshot, screenshots = picturesFolder().string(), shaders, path;
  RenderSettings settings;
  bool bare = false;
  bool forget = false;
};

void declare(CLI::App& app, Options& o) {
  addOption(app, "PLACE", o.places, "Scenes, harmonised models or 3D videos to open");
  addSize(app, "--size", o.size, "Window size [1280x720]");
  addInt(app, "--frames", o.session.frames, 0, 1000000000,
         "Number of frames of the opened scene after which the program exits; 0: exit when the window is closed");
  addOption(app, "--screenshot", o.screenshot, "Image of the view, written when the program exits").type("FILE");
  addOption(app, "--screenshots", o.screenshots,
            fmt::format("Folder for screenshots, camera paths and videos [{}]", o.screenshots))
      .type("DIR");
  addParsed(
      app, "--interface-scale",
      [&o](const std::string& text) { o.session.interfaceScale = parsedDouble("--interface-scale", text, 0.5, 8); },
      "Scale of panels and text, relative to 96 dpi [scale of the monitor]")
      .type("X");
  addOption(app, "--path", o.path, "Camera path that the first scene plays in a loop (ctrl S writes a camera path)")
      .type("FILE");
  addFlag(app, "--no-interface", o.bare, "Start with the interface hidden (F2 shows the interface)");
  addFlag(app, "--forget", o.forget, "Neither load nor save state between runs, such as panel positions and pipelines");
  addOption(app, "--shaders", o.shaders, "Folder shaders of a source tree; edited shaders are reloaded immediately")
      .type("DIR");
  addFlag(app, "--validation", o.session.validation, "Report errors found by Vulkan's validation layers");
  addOption(app, "--lose-device", o.session.loseAtFrame, "").group("");  // for tests, like the next two
  addOption(app, "--lose-surface", o.session.loseSurfaceAtFrame, "").group("");
  addFlag(app, "--only-srgb", o.session.onlySrgb, "").group("");
  inGroup(app, "Scenes", [&] {
    declareSettings(app, o.settings);
    declareOverlays(app, o.settings);
    declareGpuScene(app, o.session.gpuScene);
  });
  declareCommonOptions(app, o.common);
}

// Restarts the session after a lost device (a driver reset). Gives up at the fourth loss in a row, 10 s apart at most.
void runSessions(Window& window, Interface& interface, Viewer& viewer, const SessionOptions& options) {
  using Clock = std::chrono::steady_clock;
  int losses = 0;
  for (auto begun = Clock::now();; begun = Clock::now()) {
    struct TakePosted {
      Viewer& viewer;
      ~TakePosted() { viewer.takePosted(); }
    } takePosted{viewer};  // declared before the session: the messages of its end
    try {
      ViewerSession session(window, interface, viewer, options);
      session.run();
      if (session.validationMessages() > 0)
        fail(ErrorCode::vulkan, "Vulkan's validation layers reported {} messages", session.validationMessages());
      return;
    } catch (const Error& e) {
      losses = Clock::now() - begun < std::chrono::seconds(10) ? losses + 1 : 1;
      if (e.code() != ErrorCode::deviceLost || losses > 3) throw;
      viewer.logMessage(LogLevel::warning, std::string("the device was lost; the session restarts: ") + e.what());
    }
  }
}

// Trust statistics of the view; null if unknown. JSON writes infinite values as null.
nlohmann::ordered_json trustJson(const OpenItem& place) {
  if (!place.trust) return {};
  return {{"tiers", place.trust->tiers},
          {"depthError", place.trust->depthError},
          {"extrapolation", place.trust->extrapolation}};
}

// Measured presets. The PSNR of a picture identical to the reference is infinite, which JSON writes as null.
nlohmann::ordered_json comparisonJson(const OpenItem& place) {
  nlohmann::ordered_json lines = nlohmann::ordered_json::object();
  if (place.comparison)
    for (const ComparedSettings& line : place.comparison->lines)
      if (line.measured) lines[line.name] = {{"ms", line.measured->milliseconds}, {"psnr", line.measured->psnr}};
  return lines;
}

// Times of the last consecutive frames, and of the first picture.
nlohmann::ordered_json timesJson(const Viewer& viewer) {
  using Json = nlohmann::ordered_json;
  std::vector<double> frames;
  for (std::size_t back = 0; back < std::min(viewer.frames, FrameHistory::kLength); ++back)
    if (const float ms = viewer.history.of(viewer.frames - back).sinceLast; !std::isnan(ms))
      frames.push_back(double(ms));
  return {{"firstPicture", viewer.firstPicture ? Json(*viewer.firstPicture) : Json()},  // s
          {"framesMs", {{"count", frames.size()}, {"p50", quantile(frames, 0.5)}, {"p95", quantile(frames, 0.95)}}}};
}

// Peak resident memory, bytes.
std::uint64_t residentBytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return std::uint64_t(usage.ru_maxrss) * 1024;
}

nlohmann::ordered_json report(const Viewer& viewer, const Window& window) {
  using Json = nlohmann::ordered_json;
  Json places = Json::array();
  for (const auto& place : viewer.items) {
    const glm::dvec3& p = place->navigation.pose.position;
    const glm::dquat& q = place->navigation.pose.rotation;
    const auto& centre = place->navigation.centre;
    places.push_back({{"path", place->path.string()},
                      {"photographs", place->viewpoints.size()},
                      {"position", {p.x, p.y, p.z}},
                      {"rotation", {q.x, q.y, q.z, q.w}},
                      {"fovY", place->navigation.fovY},
                      {"centre", centre ? Json{centre->x, centre->y, centre->z} : Json()},
                      {"trust", trustJson(*place)},
                      {"effects", comparisonJson(*place)},
                      {"settings", settingsOf(*place, {})}});
  }
  const VkExtent2D size = window.pixels();
  Json warnings = Json::array(), said = Json::array();
  for (const LogLine& line : viewer.log) (line.level >= LogLevel::warning ? warnings : said).push_back(line.text);
  return Json{{"frames", viewer.frames},        {"size", {size.width, size.height}}, {"current", viewer.current},
              {"onDevice", viewer.onDevice},    {"times", timesJson(viewer)},        {"residentBytes", residentBytes()},
              {"documents", std::move(places)}, {"warnings", std::move(warnings)},   {"messages", std::move(said)}};
}

ExitCode show(Viewer& viewer, int argc, char** argv) {
  Options o;
  o.session.begun = std::chrono::steady_clock::now();
  const ProgramText program{kName, std::string(version()),
                            "Examples:\n"
                            "  ibr-viewer scene\n"
                            "  ibr-viewer scene model video --preset fast\n"
                            "  ibr-viewer scene --frames 30 --screenshot view.png\n\n"
                            "Shows scenes, harmonised models and 3D video in a window. F1 lists the keys.\n"};
  const auto ends = parseCommandLine(program, argc, argv, [&](CLI::App& app) { declare(app, o); });
  if (ends) return *ends;
  const Context context(o.common);
  o.session.device = o.common.device;
  o.session.screenshot = o.screenshot;
  o.session.shaders = o.shaders;
  o.session.screenshots = o.screenshots;

  Window window("ibr", o.size.width, o.size.height);
  const fs::path settings = o.forget ? fs::path() : settingsFolder(), cache = o.forget ? fs::path() : cacheFolder();
  if (!cache.empty()) o.session.pipelineCache = cache / "pipelines.bin";
  Interface interface(window, settings.empty() ? fs::path() : settings / "viewer.ini");
  viewer.mirror = context.log();
  viewer.first = o.settings;
  viewer.logMessage(LogLevel::info, "settings: " + presetText(o.settings));
  if (!o.path.empty()) viewer.initialCameraPath = readCameraPath(o.path);
  viewer.showInterface = !o.bare;
  for (const std::string& path : o.places) viewer.open(path);
  runSessions(window, interface, viewer, o.session);
  context.report(report(viewer, window));
  viewer.mirror = {};
  return viewer.failed && viewer.items.empty() ? kExitRunTime : kExitOk;
}

}  // namespace
}  // namespace ibr::app

// Scenes that are still being read are not waited for: a stopped thread frees its document value by value, which takes
// about a second for a hundred megabytes.
int main(int argc, char** argv) {
  using namespace ibr::app;
  Viewer viewer;
  const ExitCode code = guarded(kName, [&] { return show(viewer, argc, argv); });
  viewer.jobs.clear();
  for (Opening& opening : viewer.opening) opening.item.requestStop();
  if (!viewer.opening.empty()) exitWithoutWaiting(code);
  return code;
}
