// SPDX-License-Identifier: Apache-2.0
// Cameras as JSON. Camera paths, views as text, and the records inside images share this format.
#pragma once

#include <numbers>

#include "ibr/camera.h"
#include "shared/json/json_field.h"

namespace ibr::app {

constexpr double kMaxCoordinate = 1e15;
constexpr double kMinFov = 1e-3, kMaxFov = std::numbers::pi - 1e-3;  // radians

/// Returns a unit quaternion unchanged and any other divided by its length. A second division would change the last
/// bits, and two images of the same view would differ.
glm::dquat unitRotation(const glm::dquat& rotation);

/// Adds "position":[x,y,z] and "rotation":[x,y,z,w] to `json`.
void addPose(nlohmann::ordered_json& json, const Pose& pose);
/// Reads both fields: numbers up to 1e15, rotation of unit length within 1e-3. Throws Error{invalidInput}.
Pose poseOf(const JsonField& object);

/// Reads "fovY": radians, from 0.001 to π − 0.001. Throws Error{invalidInput}.
double fovOf(const JsonField& object);

/// {"model","width","height","fx","fy","cx","cy"}; the last four for pinholes only.
nlohmann::ordered_json intrinsicsJson(const Intrinsics& intrinsics);
Intrinsics intrinsicsOf(const JsonField& object);

}  // namespace ibr::app
