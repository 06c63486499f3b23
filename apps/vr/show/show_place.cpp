// SPDX-License-Identifier: Apache-2.0
// Show: loads, shows and leaves a scene.
#include <chrono>
#include <utility>

#include "ibr/error.h"
#include "shared/cli/settings.h"
#include "vr/show/show.h"

namespace ibr::app {

using namespace std::chrono_literals;

EyeFormat Show::eyeFormat() const {
  return {images_.extent(), images_.format(), {session_.hiddenArea(0), session_.hiddenArea(1)}};
}

void Show::beginLoading() {
  waitedSeconds_ = 0;
  // The main thread does not change the parts of the visit that the loading thread uses.
  loading_ = std::async(std::launch::async, [this, eyes = eyeFormat()] {
    std::shared_ptr<const PlaceFiles>& files = visit_.files[visit_.current];
    if (!files)
      files =
          std::make_shared<PlaceFiles>(readPlace(options().places[visit_.current], visit_.firstScale(visit_.current)));
    checkCells(options().settings, files->scene);
    GpuSceneOptions gpuScene = options().gpuScene;
    gpuScene.log = visit_.context.log();
    return std::make_unique<StereoPlace>(headset_.device(nullptr), files, levelsOf(*files), options().floor, eyes,
                                         gpuScene);
  });
}

// Returns the governor's ladder of settings for the scene, starting with the requested settings.
std::vector<RenderSettings> Show::levelsOf(const PlaceFiles& files) const {
  RenderSettings asked = options().settings;
  asked.composition = files.canBeGathered ? visit_.composition : Composition::cells;
  return ladder(asked, files.scene.cells.size(), files.scene.backdrops.size());
}

void Show::takeLoaded() {
  if (!loading_.valid() || loading_.wait_for(0s) != std::future_status::ready) return;
  try {
    settle(loading_.get());
  } catch (const Error& e) {
    if (e.code() == ErrorCode::deviceLost || !visit_.former) throw;
    goBack(e.what());
  } catch (const std::exception& e) {
    if (!visit_.former) throw;
    goBack(e.what());
  }
}

// Reports a scene that cannot be shown, and loads the previous scene again, with the user's previous position.
void Show::goBack(const std::string& why) {
  trouble_ = why;
  say(LogLevel::error, why);
  visit_.current = *std::exchange(visit_.former, std::nullopt);
  visit_.walk = std::exchange(visit_.formerWalk, std::nullopt);
  beginLoading();
}

void Show::settle(std::unique_ptr<StereoPlace> place) {
  place_ = std::move(place);
  visit_.former.reset();
  visit_.formerWalk.reset();
  for (std::size_t i = 0; i < visit_.files.size(); ++i)
    if (i != visit_.current) visit_.files[i].reset();
  const PlaceFiles& files = place_->files();
  if (!files.level)
    say(LogLevel::warning,
        fmt::format("{}: the photographs have no common up direction; y is used", files.path.string()));
  governor_ = startGovernor(levelsOf(files));
  excuse(governor_);
  pending_ = {};
  map_ = mapOf(files.walk.spots, files.walk.up);
  if (!visit_.walk)
    visit_.walk = startWalk(files.walk, visit_.walking, 0);
  else
    recentred(*visit_.walk, std::nullopt);  // a new headset session may have its space elsewhere
  if (menu_.isOpen() || !trouble_.empty()) menu_.open(head_);
}

// The view is black when this is called.
void Show::leavePlace() {
  ring_.wait();
  place_.reset();
  menu_.close();
  trouble_.clear();
  visit_.keepScale();
  visit_.formerWalk = std::exchange(visit_.walk, std::nullopt);
  visit_.former = visit_.current;
  visit_.current = *std::exchange(nextPlace_, std::nullopt);
  beginLoading();
}

}  // namespace ibr::app
