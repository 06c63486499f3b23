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
  std::optional<glm::dvec3> up;  // unit, world: up direction for navigation
};

/// Returns {"position":[x,y,z],"rotation":[x,y,z,w],"fovY":radians,"up":[x,y,z]} on one line; the fields of a camera
/// path's key. For a unit rotation, reading restores the same bits.
std::string viewText(const TextView& view);

/// Reads viewText's format. "up" and "time" (as in a path's key) are optional; other fields are refused. White space at
/// the ends is allowed. Throws Error{invalidInput} that names the field. Limits: numbers up to 1e15; rotation and up of
/// unit length within 1e-3 (they are normalised); fovY from 0.001 to π − 0.001; no repeated or unknown field; at most
/// 4096 characters.
TextView viewOf(const std::string& text);

}  // namespace ibr::app
