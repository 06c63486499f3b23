// SPDX-License-Identifier: Apache-2.0
#include "viewer/control/controls.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <imgui.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "shared/cli/settings.h"

namespace ibr::app {
namespace {

constexpr std::array kKeys{
    KeyHelp{"W A S D", "move"},
    KeyHelp{"Q E", "down, up"},
    KeyHelp{"right mouse button, arrows", "look around"},
    KeyHelp{"middle mouse button", "orbit the point under the pointer"},
    KeyHelp{"shift, alt", "faster, slower"},
    KeyHelp{"mouse wheel", "speed; with ctrl: field of view"},
    KeyHelp{"[ ]", "previous, next photograph"},
    KeyHelp{"backspace", "nearest photograph"},
    KeyHelp{"ctrl page up, down", "previous, next open scene"},
    KeyHelp{"space", "3D video: play, pause"},
    KeyHelp{"L", "level the horizon"},
    KeyHelp{"G", "image graph: camera frusta and cells"},
    KeyHelp{"B", "stay near the photographs: on, off"},
    KeyHelp{"K, J", "add a key to the camera path; play the path"},
    KeyHelp{"ctrl S", "save the path, for ibr render --poses"},
    KeyHelp{"ctrl M", "render a video of the path"},
    KeyHelp{"O", "next overlay: wireframe, tiers, depth and more; with shift: previous"},
    KeyHelp{"P", "screenshot"},
    KeyHelp{"ctrl C, ctrl V", "copy, paste the view as text"},
    KeyHelp{"F1", "this help"},
    KeyHelp{"F2", "show or hide the interface"},
    KeyHelp{"1 to 8", "pages of the side panel"},
    KeyHelp{"F6", "keyboard focus: each panel in turn (arrows, space, enter), then the view"},
    KeyHelp{"ctrl +, -, 0", "larger, smaller interface; original size"},
    KeyHelp{"ctrl O, ctrl W", "open, close a scene"},
    KeyHelp{"ctrl Q", "quit"},
};

// Returns true while a panel uses the keyboard, so that keys do not move the camera. A mere click does not count.
bool panelTakesKeys(const Viewer& viewer) {
  const ImGuiIO& io = ImGui::GetIO();
  return io.WantTextInput || io.NavVisible || viewer.panelHasKeys || viewer.asksForFolder;
}

NavigationInput handsOf(const Viewer& viewer, OpenItem& place, double seconds) {
  const ImGuiIO& io = ImGui::GetIO();
  NavigationInput hands{.seconds = seconds, .fast = io.KeyShift, .slow = io.KeyAlt};
  const glm::dvec2 pulled(double(io.MouseDelta.x), double(io.MouseDelta.y));
  // Ignores the mouse motion of the frame in which a button goes down: that motion came before the press.
  const auto holds = [&](ImGuiMouseButton button) {
    return !io.WantCaptureMouse && ImGui::IsMouseDown(button) && !ImGui::IsMouseClicked(button);
  };
  if (holds(ImGuiMouseButton_Right)) hands.look = pulled;
  if (!io.WantCaptureMouse && ImGui::IsMouseClicked(ImGuiMouseButton_Middle))
    place.pickAt = glm::dvec2(double(io.MousePos.x * io.DisplayFramebufferScale.x),
                              double(io.MousePos.y * io.DisplayFramebufferScale.y));
  if (holds(ImGuiMouseButton_Middle)) hands.orbit = pulled;
  if (!io.WantCaptureMouse && io.KeyCtrl)
    place.walk.fovY = std::clamp(place.walk.fovY * std::exp(-0.1 * double(io.MouseWheel)), 0.1, 2.6);
  else if (!io.WantCaptureMouse)
    hands.wheel = double(io.MouseWheel);
  if (io.KeyCtrl || panelTakesKeys(viewer)) return hands;
  const auto down = [&](int key) { return ImGui::IsKeyDown(key) && !viewer.shortcutKeys.contains(key) ? 1.0 : 0.0; };
  // Arrows navigate inside a panel as soon as the panel has been clicked.
  constexpr double kArrow = 400;  // px/s
  if (!ImGui::IsWindowFocused(ImGuiFocusedFlags_AnyWindow))
    hands.look += kArrow * seconds *
                  glm::dvec2(down(GLFW_KEY_RIGHT) - down(GLFW_KEY_LEFT), down(GLFW_KEY_DOWN) - down(GLFW_KEY_UP));
  hands.move = {down(GLFW_KEY_D) - down(GLFW_KEY_A), down(GLFW_KEY_E) - down(GLFW_KEY_Q),
                down(GLFW_KEY_S) - down(GLFW_KEY_W)};
  return hands;
}

// Returns true for inputs that end the playback of a camera path.
bool handsMove(const NavigationInput& hands) {
  return hands.move != glm::dvec3(0) || hands.look != glm::dvec2(0) || hands.orbit != glm::dvec2(0);
}

// Returns true if a flight, a panel or a key moved the camera since the path was last shown.
bool wasMoved(const OpenItem& place) {
  const Navigation& walk = place.walk;
  return walk.flight || walk.pose.position != place.routePose.position ||
         walk.pose.rotation != place.routePose.rotation || walk.fovY != place.routeFovY;
}

// Returns true while the playback continues.
bool followRoute(OpenItem& place, double seconds) {
  const double first = place.route.keys.front().time, whole = place.route.keys.back().time - first;
  const Camera shown = cameraAt(place.route, first + place.routeTime);
  place.walk.pose = place.routePose = shown.pose;
  place.walk.fovY = place.routeFovY = 2 * std::atan(0.5 * shown.intrinsics.height / shown.intrinsics.fy);
  place.walk.velocity = glm::dvec3(0);
  place.showingRoute = place.routeTime < whole;  // the last key itself is shown before the end
  const double next = place.routeTime + seconds;
  place.routeTime = place.repeatingRoute && whole > 0 ? std::fmod(next, whole) : next;
  return place.showingRoute;
}

void goTo(OpenItem& place, std::optional<std::size_t> viewpoint) {
  if (viewpoint) place.flyToViewpoint(*viewpoint);
}

void turnOverlays(OpenItem& place, bool back) {
  if (!place.scene || !overlaysGoWith(place.settings)) return;
  const std::size_t n = kOverlays.size();
  place.settings.overlay = kOverlays[(std::size_t(place.settings.overlay) + (back ? n - 1 : 1)) % n].overlay;
  place.changed = true;
}

void turnComposition(OpenItem& place) {
  if (!place.scene) return;
  place.settings.composition = next(place.settings.composition);
  place.changed = true;
}

// Handles keys that act on the open scene.
void pressInPlace(Viewer& viewer, OpenItem& place, const KeyPress& press) {
  switch (press.key) {
    case GLFW_KEY_O:
      return turnOverlays(place, press.shift);
    case GLFW_KEY_C:
      return turnComposition(place);
    case GLFW_KEY_RIGHT_BRACKET:
      return goTo(place, nextCamera(place.poses(), place.walk.pose, 1));
    case GLFW_KEY_LEFT_BRACKET:
      return goTo(place, nextCamera(place.poses(), place.walk.pose, -1));
    case GLFW_KEY_BACKSPACE:
      return goTo(place, nearestCamera(place.poses(), place.walk.pose));
    case GLFW_KEY_L:
      place.walk.pose = levelled(place.walk.pose, place.walk.up);
      place.changed = true;
      return;
    case GLFW_KEY_G:
      place.showGraph = !place.showGraph;
      place.changed = true;
      return;
    case GLFW_KEY_K:
      return place.addRouteKey();
    case GLFW_KEY_J:
      return place.showRoute();
    case GLFW_KEY_B:
      place.bounded = !place.bounded;
      return;
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

void pressWithControl(Viewer& viewer, int key) {
  constexpr float kStep = 1.25f;
  const std::size_t n = viewer.places.size();
  switch (key) {
    case GLFW_KEY_O:
      viewer.asksForFolder = true;
      return;
    case GLFW_KEY_W:
      return viewer.closeCurrent();
    case GLFW_KEY_S:
      viewer.wantsRoute = true;
      return;
    case GLFW_KEY_M:
      viewer.wantsVideo = true;
      return;
    case GLFW_KEY_C:
      viewer.wantsCopy = true;
      return;
    case GLFW_KEY_V:
      viewer.wantsPaste = true;
      return;
    case GLFW_KEY_PAGE_DOWN:
      if (n > 0) viewer.current = (viewer.current + 1) % n;
      return;
    case GLFW_KEY_PAGE_UP:
      if (n > 0) viewer.current = (viewer.current + n - 1) % n;
      return;
    case GLFW_KEY_EQUAL:
    case GLFW_KEY_KP_ADD:
      viewer.interfaceScale = std::min(viewer.interfaceScale * kStep, 3.0f);
      return;
    case GLFW_KEY_MINUS:
    case GLFW_KEY_KP_SUBTRACT:
      viewer.interfaceScale = std::max(viewer.interfaceScale / kStep, 0.5f);
      return;
    case GLFW_KEY_0:
    case GLFW_KEY_KP_0:
      viewer.interfaceScale = 1;
      return;
    default:
      return;
  }
}

void pressOne(Viewer& viewer, const KeyPress& press) {
  if (press.control) viewer.shortcutKeys.insert(press.place);
  if (press.key == GLFW_KEY_F1) viewer.showHelp = !viewer.showHelp;
  if (press.key == GLFW_KEY_F2) viewer.showInterface = !viewer.showInterface;
  if (press.key == GLFW_KEY_F6) viewer.wantsPanelKeys = viewer.showInterface = true;
  if (press.control && press.key == GLFW_KEY_Q) viewer.wantsClose = true;
  if (ImGui::GetIO().WantTextInput || viewer.asksForFolder) return;
  if (press.control) return pressWithControl(viewer, press.key);
  if (panelTakesKeys(viewer)) return;
  if (press.key >= GLFW_KEY_1 && press.key <= GLFW_KEY_9) {
    viewer.shownPanel = std::size_t(press.key - GLFW_KEY_1);
    viewer.showInterface = true;
  }
  if (OpenItem* place = viewer.place()) pressInPlace(viewer, *place, press);
}

}  // namespace

std::span<const KeyHelp> keyHelp() {
  return kKeys;
}

void press(Viewer& viewer, std::span<const KeyPress> keys) {
  std::erase_if(viewer.shortcutKeys, [](int key) { return !ImGui::IsKeyDown(key); });
  for (const KeyPress& key : keys) pressOne(viewer, key);
}

bool control(Viewer& viewer, OpenItem& place, double seconds) {
  const Pose before = place.walk.pose;
  const double fovBefore = place.walk.fovY;
  const NavigationInput hands = handsOf(viewer, place, seconds);
  if (!ImGui::GetIO().WantCaptureMouse && ImGui::IsAnyMouseDown()) ImGui::SetWindowFocus(nullptr);
  place.showingRoute = place.showingRoute && !handsMove(hands) && !wasMoved(place);
  bool goesOn = place.showingRoute ? followRoute(place, seconds)
                                   : navigate(place.walk, hands, place.bounded ? &place.bounds : nullptr);
  bool changed = goesOn || place.walk.pose.position != before.position || place.walk.pose.rotation != before.rotation ||
                 place.walk.fovY != fovBefore;
  if (place.video && place.playing) {
    place.time = std::fmod(place.time + seconds, place.video->duration());
    changed = true;
  }
  return std::exchange(place.changed, false) || changed;
}

}  // namespace ibr::app
