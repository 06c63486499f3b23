// SPDX-License-Identifier: Apache-2.0
// VrApp: loads, shows and leaves a scene.
#include <utility>

#include "ibr/error.h"
#include "shared/cli/settings.h"
#include "vr/show/vr_app.h"

namespace ibr::app {

EyeFormat VrApp::eyeFormat() const {
  return {images_.extent(), images_.format(), {session_.hiddenArea(0), session_.hiddenArea(1)}};
}

void VrApp::beginLoading() {
  loadingSeconds_ = 0;
  loadingMenu_.line = fmt::format("loading {}", options().places[state_.current].string());
  if (state_.files[state_.current])
    beginUpload();
  else if (!state_.reading.isRunning())  // it may run since before the headset was lost
    state_.reading = SceneReading([path = options().places[state_.current], scale = state_.initialScale(state_.current),
                                   aligns = options().settings.alignCells](const std::stop_token& stop) {
      return std::make_shared<const LoadedScene>(readScene(path, scale, aligns, stop));
    });
}

void VrApp::beginUpload() {
  // The main thread does not change the parts of the state that the uploading thread uses.
  uploading_ = Background<std::unique_ptr<StereoScene>>([this, eyes = eyeFormat()](const std::stop_token& stop) {
    const std::shared_ptr<const LoadedScene>& files = state_.files[state_.current];
    checkCells(options().settings, files->scene);
    GpuSceneOptions gpuScene = options().gpuScene;
    gpuScene.log = state_.context.log();
    gpuScene.stop = stop;
    return std::make_unique<StereoScene>(headset_.device(nullptr), files, levelsOf(*files), options().floor, eyes,
                                         gpuScene);
  });
}

// Returns the governor's ladder of settings for the scene, starting with the requested settings.
std::vector<RenderSettings> VrApp::levelsOf(const LoadedScene& files) const {
  RenderSettings requested = options().settings;
  requested.composition = files.canBeGathered ? state_.composition : Composition::cells;
  return ladder(requested, files.scene.cells.size(), files.scene.backdrops.size());
}

void VrApp::collectLoadedScene() {
  try {
    if (state_.reading.isReady()) {
      state_.files[state_.current] = state_.reading.take();
      beginUpload();
    }
    if (uploading_.isReady()) enterScene(uploading_.take());
  } catch (const Error& e) {
    if (e.code() == ErrorCode::deviceLost || !state_.previousScene) throw;
    returnToPreviousScene(e.what());
  } catch (const std::exception& e) {
    if (!state_.previousScene) throw;
    returnToPreviousScene(e.what());
  }
}

// Reports a scene that cannot be shown, and loads the previous scene again, with the user's previous position.
void VrApp::returnToPreviousScene(const std::string& why) {
  lastError_ = why;
  logMessage(LogLevel::error, why);
  state_.current = *std::exchange(state_.previousScene, std::nullopt);
  state_.walk = std::exchange(state_.previousWalk, std::nullopt);
  beginLoading();
}

void VrApp::enterScene(std::unique_ptr<StereoScene> scene) {
  scene_ = std::move(scene);
  state_.previousScene.reset();
  state_.previousWalk.reset();
  for (std::size_t i = 0; i < state_.files.size(); ++i)
    if (i != state_.current) state_.files[i].reset();
  const LoadedScene& files = scene_->files();
  if (!files.level)
    logMessage(LogLevel::warning,
               fmt::format("{}: the photographs have no common up direction; y is used", files.path.string()));
  governor_ = startGovernor(levelsOf(files));
  ignoreNextFrames(governor_);
  pending_ = {};
  map_ = mapOf(files.walk.spots.all(), files.walk.up);
  menuModel_.spots = PointMap(map_.places);
  if (!state_.walk)
    state_.walk = startWalk(files.walk, state_.walking, 0);
  else
    recentred(*state_.walk, std::nullopt);  // a new headset session may have its space elsewhere
  if (menu_.isOpen() || !lastError_.empty()) menu_.open(head_);
}

// The view is black when this is called.
void VrApp::leaveScene() {
  ring_.wait();
  scene_.reset();
  menu_.close();
  lastError_.clear();
  state_.saveScale();
  state_.previousWalk = std::exchange(state_.walk, std::nullopt);
  state_.previousScene = state_.current;
  state_.current = *std::exchange(nextScene_, std::nullopt);
  beginLoading();
}

}  // namespace ibr::app
