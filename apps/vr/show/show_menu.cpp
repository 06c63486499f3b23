// SPDX-License-Identifier: Apache-2.0
// Show: fills the menu's model and executes its requests.
#include <glm/gtc/quaternion.hpp>
#include <numbers>
#include <utility>

#include "shared/cli/folders.h"
#include "shared/cli/settings.h"
#include "vr/show/show.h"

namespace ibr::app {

MenuModel Show::menuModel() const {
  MenuModel model;
  for (const std::filesystem::path& place : options().places) model.scenes.push_back(folderName(place));
  model.scene = visit_.current;
  const WalkPlace& place = place_->files().walk;
  const Pose head = inWorld(walked_.tracking, head_);
  const std::optional<std::size_t> here = nearestSpot(place.spots, head.position, place.up);
  for (std::size_t i = 0; i < map_.places.size(); ++i) model.spots.push_back({map_.places[i], here == i});
  model.you = onMap(map_, head.position);
  model.facing = directionOnMap(map_, facingOf(head.rotation, place.up));
  model.unitsPerMetre = walked_.tracking.unitsPerMetre;
  model.firstUnitsPerMetre = visit_.walk->firstUnitsPerMetre;
  model.smoothMotion = visit_.walking.smoothMotion;
  model.snapDegrees = visit_.walking.snapTurn * 180 / std::numbers::pi;
  if (session_.spaceKind() == SpaceKind::local) model.eyeHeight = visit_.eyeHeight;
  if (options().governed) model.governor = visit_.governed;
  if (place_->canBeGathered()) model.composition = wordOf(visit_.composition);
  model.line = trouble_.empty() ? pace_ : trouble_;
  return model;
}

void Show::obeyMenu(double seconds) {
  if (walked_.menuToggled) {
    if (menu_.isOpen())
      menu_.close();
    else
      menu_.open(head_);
  }
  if (!menu_.isOpen()) {
    trouble_.clear();
    return;
  }
  const MenuWishes wishes = menu_.show(menuModel(), walked_.hands, seconds);
  goTo_ = wishes.teleport;
  scale_ = wishes.scaleFactor.value_or(1);
  eyeHeight_ = wishes.eyeHeight;
  if (wishes.scene) nextPlace_ = wishes.scene;
  if (wishes.smoothMotion) visit_.walking.smoothMotion = *wishes.smoothMotion;
  if (wishes.snapDegrees) visit_.walking.snapTurn = *wishes.snapDegrees * std::numbers::pi / 180;
  if (wishes.governor) visit_.governed = *wishes.governor;
  if (wishes.nextComposition) turnComposition();
  if (wishes.recentre) standAnew();
  pictureAsked_ |= wishes.picture;
  visit_.leaving |= wishes.exit;
  if (wishes.close) menu_.close();
}

// Builds pipelines again, so the image stops for a moment.
void Show::turnComposition() {
  visit_.composition = next(visit_.composition);
  ring_.wait();
  place_->setLevels(levelsOf(place_->files()));
  changeLadder(governor_, levelsOf(place_->files()));
  excuse(governor_);
}

// While a scene is loading, the menu only offers to exit.
void Show::obeyWaitingMenu(double seconds) {
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
  model.line = fmt::format("loading {}", options().places[visit_.current].string());
  const MenuWishes wishes = menu_.show(model, hands, seconds);
  visit_.leaving |= wishes.exit;
  if (wishes.close) menu_.close();
}

// Moves the user to the nearest spot, facing as the spot's photographs do.
void Show::standAnew() {
  const WalkPlace& place = place_->files().walk;
  const Pose head = inWorld(walked_.tracking, head_);
  visit_.walk->wanted = nearestSpot(place.spots, head.position, place.up);
  visit_.walk->facesSpot = visit_.walk->wanted.has_value();
}

}  // namespace ibr::app
