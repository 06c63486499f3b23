// SPDX-License-Identifier: Apache-2.0
// A view as one line of text, for the clipboard and for messages.
#pragma once

#include <optional>
#include <string>

#include "ibr/camera.h"

namespace ibr::app {

struct TextView {
  Pose pose;
  double fovY = 0;               // radians
  std::optional<glm::dvec3> up;  // unit, world: where up is for who navigates
};

/// {"position":[x,y,z],"rotation":[x,y,z,w],"fovY":radians,"up":[x,y,z]} without a line break; the fields of a camera
/// path's key. Read again it is the same to the last bit, given a unit rotation.
std::string viewText(const TextView& view);

/// The same read back; "up" and, as a path's key has it, "time" may stand there, nothing else. White space at the ends
/// is allowed. Throws Error{invalidInput} that names the field: numbers up to 1e15, rotation and up unit within 1e-3
/// (they are divided by their length), fovY from 0.001 to π − 0.001, a field twice or unknown, and text of more than
/// 4096 characters.
TextView viewOf(const std::string& text);

}  // namespace ibr::app
