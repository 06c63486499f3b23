// SPDX-License-Identifier: Apache-2.0
// Executes requests of keys and panels between two frames.
#include <fmt/format.h>
#include <imgui.h>

#include <utility>

#include "base/check.h"
#include "base/file.h"
#include "base/vulkan/submit.h"
#include "shared/camera/view_text.h"
#include "viewer/control/job_plans.h"
#include "viewer/control/screenshot.h"
#include "viewer/viewer_session.h"

namespace fs = std::filesystem;

namespace ibr::app {

void ViewerSession::handleRequests() {
  OpenItem* item = viewer_.item();
  const auto takeRequest = [](bool& request) { return std::exchange(request, false); };
  const bool copies = takeRequest(viewer_.copyRequested), pastes = takeRequest(viewer_.pasteRequested);
  const bool saves = takeRequest(viewer_.savePathRequested), rendersVideo = takeRequest(viewer_.videoRequested);
  const bool takesScreenshot = takeRequest(viewer_.screenshotRequested);
  // A folder that cannot be written must not end the program.
  try {
    if (copies && item)
      window_.setClipboard(viewText({item->navigation.pose, item->navigation.fovY, item->navigation.up}));
    if (pastes) paste();
    if (saves) saveCameraPath();
    if (rendersVideo) startVideoJob();
    if (takesScreenshot) takeScreenshot({});
    runSceneQueries();
  } catch (const Error& e) {
    if (e.code() == ErrorCode::deviceLost) throw;
    viewer_.logMessage(LogLevel::error, e.what());
    if (item) item->comparison.reset();  // do not retry in every frame
  }
  if (pastes || saves || rendersVideo || takesScreenshot) redraws_ = 3;
}

void ViewerSession::paste() {
  OpenItem* item = viewer_.item();
  if (!item) return;
  const std::string text = window_.clipboard();
  if (text.find('{') == std::string::npos)
    return viewer_.logMessage(LogLevel::warning, "the clipboard contains no view; ctrl C copies one");
  try {
    const TextView view = viewOf(text);
    flyTo(item->navigation, view.pose, view.fovY, 0);
    item->changed = true;
  } catch (const Error& e) {
    viewer_.logMessage(LogLevel::warning, std::string("the clipboard contains no view: ") + e.what());
  }
}

fs::path ViewerSession::saveCameraPath() {
  OpenItem* item = viewer_.item();
  if (!item || item->cameraPath.keys.empty()) {
    viewer_.show("the camera path has no keys; K adds one at the current view");
    return {};
  }
  item->cameraPath.width = int(sceneImage_->target().extent.width);
  item->cameraPath.height = int(sceneImage_->target().extent.height);
  const fs::path file = freeFile(fs::absolute(options_.screenshots), "path", ".json");
  makeFolders(file.parent_path());
  writeCameraPath(file, item->cameraPath);
  viewer_.show(fmt::format("{} written", file.string()));
  return file;
}

void ViewerSession::startVideoJob() {
  const fs::path cameraPath = saveCameraPath();
  if (cameraPath.empty()) return;
  viewer_.jobs.push_back(
      std::make_unique<Job>(videoPlan(*viewer_.item(), cameraPath, options_.gpuScene, options_.device)));
}

void ViewerSession::takeScreenshot(const fs::path& file) {
  OpenItem* item = viewer_.item();
  check(item && sceneImage_ && currentItemOnDevice(), ErrorCode::invalidInput, "{}no screenshot: {}",
        file.empty() ? std::string() : file.string() + ": ", item ? "the scene is still loading" : "no scene is open");
  waitIdle(device_);
  const VkExtent2D extent = sceneImage_->target().extent;
  PictureJob job =
      screenshotJob(file, fs::absolute(options_.screenshots), currentItemOnDevice()->picture(extent, frame_),
                    item->scene.has_value(), recordOf(*item, extent, options_.gpuScene));
  job.required = !file.empty();
  writer_.add(std::move(job));
}

void ViewerSession::reportPictures(const std::vector<PictureResult>& results) {
  for (const PictureResult& result : results) {
    redraws_ = 3;
    if (!result.error) {
      for (const fs::path& file : result.files) viewer_.show(fmt::format("{} written", file.string()));
      continue;
    }
    try {
      std::rethrow_exception(result.error);
    } catch (const Error& e) {
      if (result.required) throw;
      viewer_.logMessage(LogLevel::error, e.what());
    }
  }
}

// Executes requests about the scene, and measures trust once the view rests. Runs after the frame was submitted,
// because its photographs are streamed by then.
void ViewerSession::runSceneQueries() {
  OpenItem* item = viewer_.item();
  ItemOnDevice* drawn = currentItemOnDevice();
  if (!drawn || !sceneImage_) return;
  const VkExtent2D extent = sceneImage_->target().extent;
  if (const auto pixel = std::exchange(item->pickPixel, std::nullopt)) {
    if (const auto point = drawn->pointAt(extent, *pixel))
      item->navigation.centre = point;
    else
      viewer_.show(item->navigation.centre ? "no depth at this pixel: the orbit keeps its centre"
                                           : "no depth at this pixel to orbit around");
  }
  if (std::exchange(item->comparisonRequested, false)) item->comparison = comparisonOf(*item, extent, device_.kind());
  if (item->comparison && !item->comparison->done() && !ImGui::IsAnyMouseDown()) {
    measureNext(*item->comparison, *drawn, frame_);
    drawingPaused_ = true;  // the time of a measurement must not count as a frame time
    redraws_ = 3;
  }
  if (imageOutdated_ || item->playing) {
    item->trust.reset();
  } else if (!item->trust && viewer_.showInterface) {
    item->trust = drawn->trust(extent);
    if (item->trust) redraws_ = 3;
  }
}

}  // namespace ibr::app
