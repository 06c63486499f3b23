// SPDX-License-Identifier: Apache-2.0
#include "shared/camera/navigation.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/quaternion.hpp>
#include <glm/trigonometric.hpp>

#include "base/check.h"
#include "shared/camera/camera_json.h"

namespace ibr::app {
namespace {

constexpr double kMaxStepSeconds = 1;      // longest step that is simulated, s
constexpr double kInertia = 0.1;           // time constant of the velocity, s: 63 % of a change take this time
constexpr double kStopShare = 1e-3;        // share of the speed below which the camera stops
constexpr double kFast = 4, kSlow = 0.25;  // factors on the speed
constexpr double kNotch = 1.2;             // factor on the speed for a notch of the wheel
constexpr double kMinSpeed = 1e-9, kMaxSpeed = 1e12;
constexpr double kFieldPx = 600;  // pointer path that turns the view by its field of view, px
constexpr double kOrbitPx = 600;  // pointer path that orbits by half a turn, px
const double kMaxPitch = glm::radians(89.0);

bool isFinite(const NavigationInput& input) {
  const double all[] = {input.seconds, input.move.x,  input.move.y,  input.move.z, input.look.x,
                        input.look.y,  input.orbit.x, input.orbit.y, input.wheel};
  return std::ranges::all_of(all, [](double value) { return std::isfinite(value); });
}

// Horizontal axis to the right of the camera, about which the camera pitches.
glm::dvec3 levelRight(const glm::dquat& rotation, glm::dvec3 up) {
  const glm::dvec3 ahead = rotation * glm::dvec3(0, 0, -1), across = glm::cross(ahead, up);
  const double length = glm::length(across);
  if (length > 1e-6) return across / length;
  const glm::dvec3 right = rotation * glm::dvec3(1, 0, 0);  // looking straight up or down: the image's x axis
  return glm::normalize(right - glm::dot(right, up) * up);
}

// Rotation of the world's axes for a turn by `radians` to the right and down, clamped to 89° of the horizon.
glm::dquat turnOf(const glm::dquat& rotation, glm::dvec3 up, glm::dvec2 radians) {
  const glm::dvec3 ahead = rotation * glm::dvec3(0, 0, -1);
  const double height = std::asin(std::clamp(glm::dot(ahead, up), -1.0, 1.0));
  const double wanted =
      std::clamp(height - radians.y, std::min(height, -kMaxPitch), std::max(height, kMaxPitch)) - height;
  return glm::angleAxis(-radians.x, up) * glm::angleAxis(wanted, levelRight(rotation, up));
}

bool moves(glm::dvec2 px) {
  return px.x != 0 || px.y != 0;
}

void look(Navigation& state, glm::dvec2 px) {
  if (!moves(px)) return;
  const double perPx = state.fovY / kFieldPx;
  state.pose.rotation = glm::normalize(turnOf(state.pose.rotation, state.up, px * perPx) * state.pose.rotation);
}

void orbit(Navigation& state, glm::dvec2 px) {
  if (!moves(px) || !state.centre) return;
  const glm::dquat turn = turnOf(state.pose.rotation, state.up, px * (glm::radians(180.0) / kOrbitPx));
  state.pose.position = *state.centre + turn * (state.pose.position - *state.centre);
  state.pose.rotation = glm::normalize(turn * state.pose.rotation);
}

glm::dvec3 wantedVelocity(const Navigation& state, const NavigationInput& input) {
  const glm::dvec3 m = glm::clamp(input.move, -1.0, 1.0);
  glm::dvec3 direction = state.pose.rotation * glm::dvec3(m.x, 0, m.z) + m.y * state.up;
  const double length = glm::length(direction);
  if (length > 1) direction /= length;
  return direction * state.speed * (input.fast ? kFast : 1) * (input.slow ? kSlow : 1);
}

// Exact solution of v' = (wanted − v) / inertia over the step.
void fly(Navigation& state, glm::dvec3 wanted, double seconds) {
  const double left = std::exp(-seconds / kInertia);
  state.pose.position += wanted * seconds + (state.velocity - wanted) * (kInertia * (1 - left));
  state.velocity = wanted + (state.velocity - wanted) * left;
  if (wanted == glm::dvec3(0) && glm::length(state.velocity) < kStopShare * state.speed) {
    state.pose.position += state.velocity * kInertia;  // the remaining way of the exponential decay
    state.velocity = glm::dvec3(0);
  }
}

// Quintic ease from 0 to 1, with zero velocity and acceleration at both ends.
double eased(double u) {
  return u * u * u * (u * (6 * u - 15) + 10);
}

void follow(Navigation& state, double seconds) {
  Flight& flight = *state.flight;
  flight.elapsed += seconds;
  if (flight.elapsed >= flight.seconds) {
    state.pose = flight.to;
    state.fovY = flight.toFovY;
    state.flight.reset();
    return;
  }
  const double u = eased(flight.elapsed / flight.seconds);
  state.pose.position = glm::mix(flight.from.position, flight.to.position, u);
  state.pose.rotation = glm::normalize(glm::slerp(flight.from.rotation, flight.to.rotation, u));
  state.fovY = std::lerp(flight.fromFovY, flight.toFovY, u);
}

}  // namespace

bool navigate(Navigation& state, const NavigationInput& input, const RoamingBounds* bounds) {
  check(isFinite(input) && input.seconds >= 0, ErrorCode::invalidInput, "navigation: input is not finite");
  const double seconds = std::min(input.seconds, kMaxStepSeconds);
  state.speed =
      std::clamp(state.speed * std::pow(kNotch, std::clamp(input.wheel, -100.0, 100.0)), kMinSpeed, kMaxSpeed);
  const bool wantsMove = input.move != glm::dvec3(0);
  if (wantsMove || moves(input.look) || moves(input.orbit)) state.flight.reset();
  if (state.flight) {
    follow(state, seconds);
    return state.flight.has_value();
  }
  const glm::dvec3 before = state.pose.position;
  look(state, 0.5 * input.look);
  if (wantsMove || state.velocity != glm::dvec3(0)) fly(state, wantedVelocity(state, input), seconds);
  look(state, 0.5 * input.look);
  orbit(state, input.orbit);
  if (bounds && state.pose.position != before)
    state.pose.position = clampedToBounds(*bounds, before, state.pose.position);
  return wantsMove || state.velocity != glm::dvec3(0);
}

void flyTo(Navigation& state, const Pose& pose, double fovY, double seconds) {
  check(std::isfinite(seconds) && seconds >= 0, ErrorCode::invalidInput,
        "navigation: a flight of {} s: the duration must be finite and at least 0", seconds);
  state.velocity = glm::dvec3(0);
  state.flight = Flight{state.pose, {pose.position, unitRotation(pose.rotation)}, state.fovY, fovY, seconds, 0};
  if (seconds == 0) follow(state, 0);
}

std::optional<glm::dvec3> pickedPoint(const Camera& camera, glm::dvec2 pixel, double depth) {
  if (!std::isfinite(depth) || !(depth > 0)) return std::nullopt;
  const glm::dvec3 direction = unproject(camera.intrinsics, pixel);
  if (!(-direction.z > 0)) return std::nullopt;
  return camera.pose.position + camera.pose.rotation * (direction * (depth / -direction.z));
}

Pose levelled(const Pose& pose, glm::dvec3 up) {
  const glm::dvec3 back = pose.rotation * glm::dvec3(0, 0, 1), across = glm::cross(up, back);
  const double length = glm::length(across);
  if (length <= 1e-6) return pose;
  const glm::dvec3 right = across / length;
  return {pose.position, glm::normalize(glm::quat_cast(glm::dmat3(right, glm::cross(back, right), back)))};
}

}  // namespace ibr::app
