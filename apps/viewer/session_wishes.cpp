// SPDX-License-Identifier: Apache-2.0
// Executes requests of keys and panels between two frames.
#include <fmt/format.h>
#include <imgui.h>

#include <utility>

#include "base/check.h"
#include "base/file.h"
#include "shared/camera/view_text.h"
#include "viewer/control/job_plans.h"
#include "viewer/control/screenshot.h"
#include "viewer/viewer_session.h"

namespace fs = std::filesystem;

namespace ibr::app {

void Session::grantWishes() {
  OpenItem* place = viewer_.place();
  const auto wished = [](bool& wish) { return std::exchange(wish, false); };
  const bool copies = wished(viewer_.wantsCopy), pastes = wished(viewer_.wantsPaste);
  const bool saves = wished(viewer_.wantsRoute), films = wished(viewer_.wantsVideo);
  const bool shoots = wished(viewer_.wantsScreenshot);
  // A folder that cannot be written must not end the program.
  try {
    if (copies && place) window_.setClipboard(viewText({place->walk.pose, place->walk.fovY, place->walk.up}));
    if (pastes) paste();
    if (saves) saveRoute();
    if (films) makeVideo();
    if (shoots) takeScreenshot(freeFile(fs::absolute(options_.screenshots), "view", ".png"));
    findOut();
  } catch (const Error& e) {
    if (e.code() == ErrorCode::deviceLost) throw;
    viewer_.say(LogLevel::error, e.what());
    if (place) place->effects.reset();  // do not retry in every frame
  }
  if (pastes || saves || films || shoots) redraws_ = 3;
}

void Session::paste() {
  OpenItem* place = viewer_.place();
  if (!place) return;
  const std::string text = window_.clipboard();
  if (text.find('{') == std::string::npos)
    return viewer_.say(LogLevel::warning, "the clipboard contains no view; ctrl C copies one");
  try {
    const TextView view = viewOf(text);
    flyTo(place->walk, view.pose, view.fovY, 0);
    place->changed = true;
  } catch (const Error& e) {
    viewer_.say(LogLevel::warning, std::string("the clipboard contains no view: ") + e.what());
  }
}

fs::path Session::saveRoute() {
  OpenItem* place = viewer_.place();
  if (!place || place->route.keys.empty()) {
    viewer_.show("the camera path has no keys; K adds one at the current view");
    return {};
  }
  place->route.width = int(picture_->target().extent.width);
  place->route.height = int(picture_->target().extent.height);
  const fs::path file = freeFile(fs::absolute(options_.screenshots), "path", ".json");
  makeFolders(file.parent_path());
  writeCameraPath(file, place->route);
  viewer_.show(fmt::format("{} written", file.string()));
  return file;
}

void Session::makeVideo() {
  const fs::path route = saveRoute();
  if (route.empty()) return;
  viewer_.jobs.push_back(std::make_unique<Job>(videoPlan(*viewer_.place(), route, options_.gpuScene, options_.device)));
}

void Session::takeScreenshot(const fs::path& file) {
  OpenItem* place = viewer_.place();
  check(place && picture_, ErrorCode::invalidInput, "{}: no screenshot: no scene is open", file.string());
  vkDeviceWaitIdle(device_.handle());
  const VkExtent2D extent = picture_->target().extent;
  const Image8 image = drawnPlace()->picture(extent, frame_);
  writeScreenshot(file, image, *place, extent, options_.gpuScene);
  viewer_.show(fmt::format("{} written", file.string()));
}

// Executes requests about the scene, and measures trust once the view rests. Runs after the frame was submitted,
// because its photographs are streamed by then.
void Session::findOut() {
  OpenItem* place = viewer_.place();
  PlaceOnDevice* drawn = place ? drawnPlace() : nullptr;
  if (!drawn || !picture_) return;
  const VkExtent2D extent = picture_->target().extent;
  if (const auto pixel = std::exchange(place->pickAt, std::nullopt)) {
    if (const auto point = drawn->pointAt(extent, *pixel))
      place->walk.centre = point;
    else
      viewer_.show(place->walk.centre ? "no depth at this pixel: the orbit keeps its centre"
                                      : "no depth at this pixel to orbit around");
  }
  if (std::exchange(place->wantsEffects, false)) place->effects = effectsOf(*place, extent, device_.kind());
  if (place->effects && !place->effects->done() && !ImGui::IsAnyMouseDown()) {
    measureNext(*place->effects, *drawn, frame_);
    rested_ = true;  // the time of a measurement must not count as a frame time
    redraws_ = 3;
  }
  if (pictureWanted_ || place->playing) {
    place->trust.reset();
  } else if (!place->trust && viewer_.showInterface) {
    place->trust = drawn->trust(extent);
    if (place->trust) redraws_ = 3;
  }
}

}  // namespace ibr::app
