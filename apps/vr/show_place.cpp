// SPDX-License-Identifier: Apache-2.0
// Show: a place is read, put on the device, shown and left.
#include <chrono>

#include "ibr/error.h"
#include "shared/settings.h"
#include "vr/show.h"

namespace ibr::app {

using namespace std::chrono_literals;

EyeFormat Show::eyeFormat() const {
  return {images_.extent(), images_.format(), {session_.hiddenArea(0), session_.hiddenArea(1)}};
}

void Show::beginLoading() {
  loadingSeconds_ = 0;
  // What the thread uses of the visit nobody changes meanwhile.
  loading_ = std::async(std::launch::async, [this, eyes = eyeFormat()] {
    std::shared_ptr<const PlaceFiles>& files = visit_.files[visit_.current];
    if (!files)
      files = std::make_shared<PlaceFiles>(readPlace(options().places[visit_.current], options().unitsPerMetre));
    checkCells(options().settings, files->scene);
    GpuSceneOptions gpuScene = options().gpuScene;
    gpuScene.log = visit_.context.log();
    const Scene& scene = files->scene;
    const auto levels = ladder(options().settings, scene.cells.size(), scene.backdrops.size());
    return std::make_unique<StereoPlace>(headset_.device(nullptr), files, levels, options().floor, eyes, gpuScene);
  });
}

// A place that cannot be shown is told of, and the former one shown again where there is one.
void Show::takeLoaded() {
  if (!loading_.valid() || loading_.wait_for(0s) != std::future_status::ready) return;
  try {
    settle(loading_.get());
  } catch (const Error& e) {
    if (e.code() == ErrorCode::deviceLost || !formerPlace_) throw;
    say(LogLevel::error, e.what());
    trouble_ = e.what();
    visit_.current = *std::exchange(formerPlace_, std::nullopt);
    beginLoading();
  }
}

void Show::settle(std::unique_ptr<StereoPlace> place) {
  place_ = std::move(place);
  formerPlace_.reset();
  const PlaceFiles& files = place_->files();
  if (!files.level)
    say(LogLevel::warning,
        fmt::format("{}: the photographs were held in too many ways to tell where up is", files.path.string()));
  governor_ = startGovernor(ladder(options().settings, files.scene.cells.size(), files.scene.backdrops.size()));
  map_ = mapOf(files.walk.spots, files.walk.up);
  if (!visit_.walk)
    visit_.walk = startWalk(files.walk, visit_.walking, 0);
  else
    recentred(*visit_.walk, std::nullopt);  // a headset that was lost may have its space elsewhere now
}

// All is black.
void Show::leavePlace() {
  ring_.wait();
  place_.reset();
  visit_.walk.reset();
  menu_.close();
  trouble_.clear();
  formerPlace_ = visit_.current;
  visit_.current = *std::exchange(nextPlace_, std::nullopt);
  beginLoading();
}

void Show::giveFloor(RenderSettings& settings) {
  floor_.reset();
  const PlaceFiles& files = place_->files();
  if (!options().floor || !files.level) return;
  glm::dvec3 middle(0);
  for (const Node& node : files.scene.nodes) middle += node.camera.pose.position / double(files.scene.nodes.size());
  constexpr double kSpacing = 0.5;  // m
  const double below = glm::dot(files.walk.up, middle - walked_.tracking.origin);
  floor_ = FloorWish{below, kSpacing * walked_.tracking.unitsPerMetre};
  settings.floor = floorBelow(files.scene, *floor_);
}

void Show::recordPlace(const FrameRing::Frame& frame, double seconds, const std::vector<Camera>& eyes,
                       std::span<const Target> targets, bool toBeKept) {
  drawnWith_ = governor_.levels[visit_.governed ? governor_.level : 0];
  drawnWith_.leaveOutHidden = !toBeKept;
  giveFloor(drawnWith_);
  const GpuScope scope(frame.commands, frame.timer, "frame");
  place_->record(frame, seconds, eyes, drawnWith_, targets);
}

}  // namespace ibr::app
