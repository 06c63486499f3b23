// SPDX-License-Identifier: Apache-2.0
// VrApp: fills the menu's model and executes its requests.
#include <glm/gtc/quaternion.hpp>
#include <numbers>
#include <utility>

#include "shared/cli/folders.h"
#include "shared/cli/settings.h"
#include "vr/show/vr_app.h"

namespace ibr::app {

MenuModel VrApp::menuModel() const {
  MenuModel model;
  for (const std::filesystem::path& scene : options().places) model.scenes.push_back(folderName(scene));
  model.scene = state_.current;
  const WalkScene& scene = scene_->files().walk;
  const Pose head = inWorld(walkOutput_.tracking, head_);
  const std::optional<std::size_t> here = nearestSpot(scene.spots, head.position, scene.up);
  for (std::size_t i = 0; i < map_.places.size(); ++i) model.spots.push_back({map_.places[i], here == i});
  model.you = onMap(map_, head.position);
  model.facing = directionOnMap(map_, facingOf(head.rotation, scene.up));
  model.unitsPerMetre = walkOutput_.tracking.unitsPerMetre;
  model.initialUnitsPerMetre = state_.walk->initialUnitsPerMetre;
  model.smoothMotion = state_.walking.smoothMotion;
  model.snapDegrees = state_.walking.snapTurn * 180 / std::numbers::pi;
  if (session_.spaceKind() == SpaceKind::local) model.eyeHeight = state_.eyeHeight;
  if (options().governorEnabled) model.governor = state_.governorEnabled;
  if (scene_->canBeGathered()) model.composition = optionValue(state_.composition);
  model.line = lastError_.empty() ? statusLine_ : lastError_;
  return model;
}

void VrApp::applyMenuRequests(double seconds) {
  if (walkOutput_.menuToggled) {
    if (menu_.isOpen())
      menu_.close();
    else
      menu_.open(head_);
  }
  if (!menu_.isOpen()) {
    lastError_.clear();
    return;
  }
  const MenuRequests requests = menu_.show(menuModel(), walkOutput_.hands, seconds);
  teleportSpot_ = requests.teleport;
  scale_ = requests.scaleFactor.value_or(1);
  eyeHeight_ = requests.eyeHeight;
  if (requests.scene) nextScene_ = requests.scene;
  if (requests.smoothMotion) state_.walking.smoothMotion = *requests.smoothMotion;
  if (requests.snapDegrees) state_.walking.snapTurn = *requests.snapDegrees * std::numbers::pi / 180;
  if (requests.governor) state_.governorEnabled = *requests.governor;
  if (requests.nextComposition) cycleComposition();
  if (requests.recentre) returnToSpot();
  screenshotRequested_ |= requests.picture;
  state_.leaving |= requests.exit;
  if (requests.close) menu_.close();
}

// Builds pipelines again, so the image stops for a moment.
void VrApp::cycleComposition() {
  state_.composition = next(state_.composition);
  ring_.wait();
  scene_->setLevels(levelsOf(scene_->files()));
  changeLadder(governor_, levelsOf(scene_->files()));
  ignoreNextFrames(governor_);
}

// While a scene is loading, the menu only offers to exit.
void VrApp::applyLoadingMenu(double seconds) {
  std::array<HandOutput, 2> hands;
  for (const Hand hand : {kLeft, kRight}) {
    const bool held = std::exchange(menuHeld_[hand], input_[hand].menu), pressed = input_[hand].menu && !held;
    if (pressed && menu_.isOpen())
      menu_.close();
    else if (pressed)
      menu_.open(head_);
    hands[hand].panelSelect = input_[hand].select;
  }
  if (!menu_.isOpen()) return;
  MenuModel model;
  model.line = fmt::format("loading {}", options().places[state_.current].string());
  const MenuRequests requests = menu_.show(model, hands, seconds);
  state_.leaving |= requests.exit;
  if (requests.close) menu_.close();
}

// Moves the user to the nearest spot, facing as the spot's photographs do.
void VrApp::returnToSpot() {
  const WalkScene& scene = scene_->files().walk;
  const Pose head = inWorld(walkOutput_.tracking, head_);
  state_.walk->wanted = nearestSpot(scene.spots, head.position, scene.up);
  state_.walk->faceSpotOnJump = state_.walk->wanted.has_value();
}

}  // namespace ibr::app
