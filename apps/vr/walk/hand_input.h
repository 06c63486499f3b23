// SPDX-License-Identifier: Apache-2.0
// What hands ask for: presses, releases and turns, out of what they hold from frame to frame.
#pragma once

#include "vr/walk/locomotion.h"

namespace ibr::app {

/// What a step goes by: input with all that is not finite taken out.
struct GivenInput {
  double seconds = 0;  // 0 to a tenth
  std::optional<Pose> head;
  std::array<HandInput, 2> hands;  // one that is not active holds nothing
};
GivenInput given(const WalkInput& input);

/// With a unit rotation; nullopt where it is not finite.
std::optional<Pose> soundPose(const Pose& pose);

/// What select does to a hand. Gives the spot that it let go at, where that counts.
std::optional<std::size_t> selected(WalkState::HandState& memory, const HandInput& hand, bool headThere);

/// True in the frame in which the menu button goes down.
bool menuPressed(WalkState::HandState& memory, const HandInput& hand);

/// 1 to the right, −1 to the left, 0: none now.
int stickTurn(WalkState& state, const std::array<HandInput, 2>& hands);

}  // namespace ibr::app
