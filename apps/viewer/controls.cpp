// SPDX-License-Identifier: Apache-2.0
#include "viewer/controls.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <imgui.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <limits>
#include <utility>

namespace ibr::app {
namespace {

constexpr std::array kKeys{
    KeyHelp{"W A S D", "move"},
    KeyHelp{"Q E", "down, up"},
    KeyHelp{"right mouse button", "look around"},
    KeyHelp{"shift, ctrl", "faster, slower"},
    KeyHelp{"mouse wheel", "speed; with ctrl the field of view"},
    KeyHelp{"[ ]", "previous, next photograph"},
    KeyHelp{"backspace", "the nearest photograph"},
    KeyHelp{"ctrl page up, down", "previous, next place that is open"},
    KeyHelp{"space", "3D video: play, pause"},
    KeyHelp{"P", "screenshot"},
    KeyHelp{"F1", "this help"},
    KeyHelp{"F2", "hide and show the interface"},
    KeyHelp{"ctrl W", "close the place"},
    KeyHelp{"ctrl Q", "quit"},
};

double down(int key) {
  return ImGui::IsKeyDown(key) ? 1.0 : 0.0;
}

// Whether the view was turned or moved.
bool fly(Place& place, double seconds) {
  const ImGuiIO& io = ImGui::GetIO();
  bool moved = false;
  // Where the button goes down the way that the mouse came there is no look.
  const bool looks = ImGui::IsMouseDown(ImGuiMouseButton_Right) && !ImGui::IsMouseClicked(ImGuiMouseButton_Right);
  if (!io.WantCaptureMouse && io.MouseWheel != 0) {
    if (io.KeyCtrl) {
      place.fovY = std::clamp(place.fovY * std::exp(-0.1 * double(io.MouseWheel)), 0.1, 2.6);
      moved = true;
    } else {
      place.speed *= std::exp(0.2 * double(io.MouseWheel));
    }
  }
  if (!io.WantCaptureMouse && looks && (io.MouseDelta.x != 0 || io.MouseDelta.y != 0)) {
    const double perPixel = place.fovY / double(io.DisplaySize.y);
    const glm::dvec3 right = place.pose.rotation * glm::dvec3(1, 0, 0);
    const glm::dquat yaw = glm::angleAxis(-double(io.MouseDelta.x) * perPixel, place.up);
    const glm::dquat pitch = glm::angleAxis(-double(io.MouseDelta.y) * perPixel, right);
    const glm::dquat turned = glm::normalize(yaw * pitch * place.pose.rotation);
    const glm::dvec3 forward = turned * glm::dvec3(0, 0, -1);
    if (std::abs(glm::dot(forward, place.up)) < 0.999) {
      // Upright: what the photograph was tilted by goes as soon as the view is turned.
      const glm::dvec3 level = glm::normalize(glm::cross(forward, place.up));
      place.pose.rotation = glm::quat_cast(glm::dmat3(level, glm::cross(level, forward), -forward));
      moved = true;
    }
  }
  if (!io.WantTextInput && !io.KeyCtrl) {
    const glm::dvec3 along(down(GLFW_KEY_D) - down(GLFW_KEY_A), 0, down(GLFW_KEY_S) - down(GLFW_KEY_W));
    const glm::dvec3 way = place.pose.rotation * along + place.up * (down(GLFW_KEY_E) - down(GLFW_KEY_Q));
    if (const double length = glm::length(way); length > 0) {
      const double faster = io.KeyShift ? 4 : 1;
      place.pose.position += way / length * (place.speed * faster * seconds);
      moved = true;
    }
  }
  if (moved) place.snapped = std::size_t(-1);
  return moved;
}

std::size_t nearestViewpoint(const Place& place) {
  std::size_t nearest = 0;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < place.viewpoints.size(); ++i)
    if (const double d = glm::distance(place.viewpoints[i].camera.pose.position, place.pose.position); d < least)
      least = d, nearest = i;
  return nearest;
}

// Those about the place that is shown.
void pressInPlace(Viewer& viewer, Place& place, int key) {
  const std::size_t n = place.viewpoints.size();
  const bool snapped = place.snapped < n;
  switch (key) {
    case GLFW_KEY_RIGHT_BRACKET:
      return place.snapTo(snapped ? (place.snapped + 1) % n : nearestViewpoint(place));
    case GLFW_KEY_LEFT_BRACKET:
      return place.snapTo(snapped ? (place.snapped + n - 1) % n : nearestViewpoint(place));
    case GLFW_KEY_BACKSPACE:
      return place.snapTo(nearestViewpoint(place));
    case GLFW_KEY_SPACE:
      place.playing = place.video && !place.playing;
      return;
    case GLFW_KEY_P:
      viewer.wantsScreenshot = true;
      return;
    default:
      return;
  }
}

void pressOne(Viewer& viewer, const KeyPress& press) {
  if (press.key == GLFW_KEY_F1) viewer.showHelp = !viewer.showHelp;
  if (press.key == GLFW_KEY_F2) viewer.showInterface = !viewer.showInterface;
  if (press.control) {
    const std::size_t n = viewer.places.size();
    if (press.key == GLFW_KEY_Q) viewer.wantsClose = true;
    if (press.key == GLFW_KEY_W) viewer.closeCurrent();
    if (press.key == GLFW_KEY_PAGE_DOWN && n > 0) viewer.current = (viewer.current + 1) % n;
    if (press.key == GLFW_KEY_PAGE_UP && n > 0) viewer.current = (viewer.current + n - 1) % n;
    return;
  }
  if (ImGui::GetIO().WantTextInput) return;
  if (Place* place = viewer.place()) pressInPlace(viewer, *place, press.key);
}

}  // namespace

std::span<const KeyHelp> keyHelp() {
  return kKeys;
}

void press(Viewer& viewer, std::span<const KeyPress> keys) {
  for (const KeyPress& key : keys) pressOne(viewer, key);
}

bool control(Place& place, double seconds) {
  bool changed = fly(place, seconds);
  if (place.video && place.playing) {
    place.time = std::fmod(place.time + seconds, place.video->duration());
    changed = true;
  }
  return std::exchange(place.changed, false) || changed;
}

}  // namespace ibr::app
