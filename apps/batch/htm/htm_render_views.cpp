// SPDX-License-Identifier: Apache-2.0
#include "batch/htm/htm_render_views.h"

#include <algorithm>
#include <functional>
#include <glm/trigonometric.hpp>
#include <nlohmann/json.hpp>

#include "base/check.h"
#include "base/file.h"
#include "batch/files/poses.h"
#include "ibr/error.h"
#include "shared/camera/auto_path.h"
#include "shared/cli/htm_view_settings.h"
#include "shared/cli/progress.h"
#include "shared/draw/htm_player.h"
#include "shared/draw/image_operations.h"
#include "shared/draw/picture_record.h"
#include "shared/report/statistics.h"

namespace fs = std::filesystem;

namespace ibr::app {
namespace {

using Json = nlohmann::ordered_json;

// An image to render.
struct TimedView {
  View view;
  double seconds = 0;    // time in the video, s
  double dtSeconds = 0;  // since the previous view, s
  bool first = false;    // true: weights do not continue from the previous view
};

std::vector<View> viewsOf(const HtmModel& model, const HtmViewsOptions& options, const Context& context) {
  if (options.autoFrames == 0) return readViews(options.poses, options.size, context.log());
  Scene scene;  // positions of the photographs only
  for (const HtmCamera& camera : model.cameras) scene.nodes.push_back({camera.name, camera.camera, {}, {}});
  return frames(autoPath(scene, options.autoFrames, options.size.width, options.size.height));
}

// Poses without times are consecutive frames of 3D video, unless --time selects one moment.
std::vector<TimedView> timedViewsOf(std::vector<View> views, const HtmViewsOptions& options, double fps) {
  const bool isPath = options.autoFrames > 0 || isWalk(options.poses);
  const bool plays = !isPath && fps > 0 && !options.time;
  std::vector<TimedView> timedViews;
  for (std::size_t i = 0; i < views.size(); ++i) {
    const double now = plays ? double(i) / fps : views[i].time;
    const double before = i == 0 ? now : plays ? double(i - 1) / fps : views[i - 1].time;
    timedViews.push_back({views[i], options.time.value_or(now), now - before, i == 0 || !(isPath || plays)});
  }
  return timedViews;
}

double coverageOf(const Image8& picture) {
  std::size_t covered = 0;
  for (std::size_t i = 3; i < picture.values.size(); i += 4) covered += picture.values[i] > 0;
  return double(covered) * 4 / double(std::max<std::size_t>(picture.values.size(), 1));
}

Json framesJson(const HtmPlayer& player) {
  Json list = Json::array();
  for (const HtmPlayer::FrameCosts& shown : player.shown())
    list.push_back({{"frame", shown.frame},
                    {"name", shown.name},
                    {"pictures", shown.pictures},
                    {"loadMs", shown.loading},
                    {"waitMs", shown.waiting},
                    {"uploadMs", shown.upload},
                    {"prepareMs", shown.preparation},
                    {"renderMs", shown.rendering}});
  return list;
}

double median(const std::vector<HtmPlayer::FrameCosts>& shown, double HtmPlayer::FrameCosts::*time) {
  std::vector<double> times;
  for (const HtmPlayer::FrameCosts& frame : shown) times.push_back(frame.*time);
  return quantile(times, 0.5);
}

void printFrames(const HtmPlayer& player, const Context& context) {
  using FrameCosts = HtmPlayer::FrameCosts;
  const std::vector<FrameCosts>& shown = player.shown();
  context.print(
      "{} frames shown; median times: loading {:.1f} ms, waiting {:.1f} ms, upload {:.1f} ms, preparation {:.1f} ms, "
      "drawing {:.1f} ms\n",
      shown.size(), median(shown, &FrameCosts::loading), median(shown, &FrameCosts::waiting),
      median(shown, &FrameCosts::upload), median(shown, &FrameCosts::preparation),
      median(shown, &FrameCosts::rendering));
}

}  // namespace

void declareHtmViews(CLI::App& app, HtmViewsOptions& options) {
  declareHtmPictureSettings(app, options.settings, options.sourceMesh);
  addParsed(
      app, "--time", [&options](const std::string& text) { options.time = parsedDouble("--time", text, 0, 1e9); },
      "3D video: render only this moment, from all poses [the time of each pose]")
      .type("SECONDS");
}

void checkHtmViews(const HtmViewsOptions& options, std::optional<AssetKind> kind) {
  if (options.time && kind == AssetKind::htmModel)
    refuseOption("--time", "is only for 3D video, but " + options.model + " is a single model");
}

ExitCode renderHtmViews(const HtmViewsOptions& options, const Context& context) {
  HtmPlayerOptions play{.sourceMesh = options.sourceMesh, .seconds = options.time.value_or(0), .graph = options.graph};
  if (options.time) play.framesAhead = 0;
  HtmPlayer player(options.model, play, context);
  std::vector<View> views = viewsOf(player.model(), options, context);
  if (options.fovDegrees > 0) setFov(views, glm::radians(options.fovDegrees));
  checkNamesDiffer(views);
  for (const View& view : views) pictureFile(options.output, view.name);  // checks all names before anything is written
  const std::vector<TimedView> timedViews = timedViewsOf(std::move(views), options, player.fps());

  Json drawn = htmSettingsJson(options.settings, options.sourceMesh);
  drawn["graph"] = options.graph;
  Json written = Json::array();
  std::vector<double> coverage, weights, coordinates, rasterisation;
  HtmPlanState walk;
  {
    ProgressLine progress(context);
    for (const TimedView& timedView : timedViews) {
      check(progress.show({"rendering", written.size(), timedViews.size()}), ErrorCode::cancelled, "stopped");
      if (timedView.first) walk = {};
      HtmPlayer::Picture picture =
          player.render(timedView.view.camera, timedView.seconds, options.settings, walk, timedView.dtSeconds);
      coverage.push_back(coverageOf(picture.image));
      if (options.graph) makeOpaque(picture.image);  // lines are drawn outside the object too
      const fs::path file = pictureFile(options.output, timedView.view.name);
      makeFolders(file.parent_path());
      writePicture(file, picture.image,
                   {timedView.view.camera, player.isVideo() ? std::optional(timedView.seconds) : std::nullopt, drawn});
      weights.push_back(picture.weights);
      coordinates.push_back(picture.coordinates);
      rasterisation.push_back(picture.rasterisation);
      Json entry{{"name", timedView.view.name},          {"file", file.string()},
                 {"coverage", coverage.back()},          {"weightsMs", picture.weights},
                 {"coordinatesMs", picture.coordinates}, {"rasterisationMs", picture.rasterisation},
                 {"milliseconds", picture.milliseconds}};
      if (player.isVideo()) {
        entry["time"] = timedView.seconds;
        entry["frame"] = picture.frame;
      }
      written.push_back(std::move(entry));
    }
    progress.show({"rendering", timedViews.size(), timedViews.size()});
  }
  context.print("{} images in {}; coverage {:.4f}, weights {:.3f} ms, coordinates {:.3f} ms, rasterisation {:.3f} ms\n",
                timedViews.size(), options.output, mean(coverage), quantile(weights, 0.5), quantile(coordinates, 0.5),
                quantile(rasterisation, 0.5));
  if (player.isVideo()) printFrames(player, context);
  Json settings = drawn;
  settings["fov"] = options.fovDegrees > 0 ? Json(options.fovDegrees) : Json();
  settings["time"] = options.time ? Json(*options.time) : Json();
  context.report(Json{{"views", written},
                      {"frames", framesJson(player)},
                      {"device", player.deviceName()},
                      {"settings", settings},
                      {player.isVideo() ? "sequence" : "model", options.model}});
  return kExitOk;
}

}  // namespace ibr::app
