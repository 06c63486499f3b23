// SPDX-License-Identifier: Apache-2.0
// Show: a place is read, put on the device, shown and left.
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
  // What the thread uses of the visit nobody changes meanwhile.
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

// All settings that a place is drawn with, what was asked for first.
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

// A place that cannot be shown is told of, and the former one shown again, as it was left.
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
        fmt::format("{}: the photographs were held in too many ways to tell where up is", files.path.string()));
  governor_ = startGovernor(levelsOf(files));
  excuse(governor_);
  pending_ = {};
  map_ = mapOf(files.walk.spots, files.walk.up);
  if (!visit_.walk)
    visit_.walk = startWalk(files.walk, visit_.walking, 0);
  else
    recentred(*visit_.walk, std::nullopt);  // a headset that was lost may have its space elsewhere now
  if (menu_.isOpen() || !trouble_.empty()) menu_.open(head_);
}

// All is black.
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
