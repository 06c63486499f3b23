// SPDX-License-Identifier: Apache-2.0
// Cameras as JSON, the same in camera paths, in views as text and inside pictures.
#pragma once

#include <numbers>

#include "ibr/camera.h"
#include "shared/camera/json_field.h"

namespace ibr::app {

constexpr double kLargestCoordinate = 1e15;
constexpr double kNarrowestFov = 1e-3, kWidestFov = std::numbers::pi - 1e-3;  // radians

/// A unit quaternion as it is, any other divided by its length: dividing twice would move the last bits, and pictures
/// of one view would differ.
glm::dquat unitRotation(const glm::dquat& rotation);

/// "position":[x,y,z] and "rotation":[x,y,z,w] are added to `json`.
void addPose(nlohmann::ordered_json& json, const Pose& pose);
/// Both are wanted, numbers up to 1e15; the rotation a unit one within 1e-3. Throws Error{invalidInput}.
Pose poseOf(const JsonField& object);

/// "fovY" in radians, from 0.001 to π − 0.001.
double fovOf(const JsonField& object);

/// {"model","width","height","fx","fy","cx","cy"}; the last four of a pinhole only.
nlohmann::ordered_json intrinsicsJson(const Intrinsics& intrinsics);
Intrinsics intrinsicsOf(const JsonField& object);

}  // namespace ibr::app
