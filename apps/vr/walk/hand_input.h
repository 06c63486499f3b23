// SPDX-License-Identifier: Apache-2.0
// Turns the state of the hands, frame by frame, into events: presses, releases and turns.
#pragma once

#include "vr/walk/locomotion.h"

namespace ibr::app {

/// Input of a step without values that are not finite.
struct SanitisedInput {
  double seconds = 0;  // 0 to 0.1
  std::optional<Pose> head;
  std::array<HandInput, 2> hands;  // inactive hands hold nothing
};
SanitisedInput sanitised(const WalkInput& input);

/// Normalises the rotation; nullopt if the pose is not finite.
std::optional<Pose> normalisedIfFinite(const Pose& pose);

/// Updates a hand's selection. Returns the spot that was pointed at when select was released, if that counts.
std::optional<std::size_t> selected(WalkState::HandState& memory, const HandInput& hand, bool headTracked);

/// True in the frame in which the menu button goes down.
bool menuPressed(WalkState::HandState& memory, const HandInput& hand);

/// Returns 1: one turn to the right, −1: to the left, 0: none.
int stickTurn(WalkState& state, const std::array<HandInput, 2>& hands);

}  // namespace ibr::app
