// SPDX-License-Identifier: Apache-2.0
// VrApp: fills the menu's model and executes its requests.
#include <glm/gtc/quaternion.hpp>
#include <numbers>
#include <utility>

#include "shared/cli/settings.h"
#include "vr/show/vr_app.h"

namespace ibr::app {

void VrApp::updateMenuModel() {
  const WalkScene& scene = scene_->files().walk;
  const Pose head = inWorld(walkOutput_.tracking, head_);
  menuModel_.scene = state_.current;
  menuModel_.here = nearestSpot(scene.spots, head.position, scene.up);
  menuModel_.you = onMap(map_, head.position);
  menuModel_.facing = directionOnMap(map_, facingOf(head.rotation, scene.up));
  menuModel_.unitsPerMetre = walkOutput_.tracking.unitsPerMetre;
  menuModel_.initialUnitsPerMetre = state_.walk->initialUnitsPerMetre;
  menuModel_.smoothMotion = state_.walking.smoothMotion;
  menuModel_.snapDegrees = state_.walking.snapTurn * 180 / std::numbers::pi;
  if (session_.spaceKind() == SpaceKind::local) menuModel_.eyeHeight = state_.eyeHeight;
  if (options().governorEnabled) menuModel_.governor = state_.governorEnabled;
  if (scene_->canBeGathered())
    menuModel_.composition = optionValue(state_.composition);
  else
    menuModel_.composition.clear();
  menuModel_.line = lastError_.empty() ? statusLine_ : lastError_;
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
  updateMenuModel();
  const MenuRequests requests = menu_.show(menuModel_, walkOutput_.hands, seconds);
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
  const MenuRequests requests = menu_.show(loadingMenu_, hands, seconds);
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
