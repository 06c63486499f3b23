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
    KeyHelp{"C", "next composition: cells, gathered, hybrid"},
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
bool panelUsesKeyboard(const Viewer& viewer) {
  const ImGuiIO& io = ImGui::GetIO();
  return io.WantTextInput || io.NavVisible || viewer.panelFocused || viewer.showOpenDialog;
}

NavigationInput readNavigationInput(const Viewer& viewer, OpenItem& item, const FrameKeys& keys, double seconds) {
  const ImGuiIO& io = ImGui::GetIO();
  NavigationInput input{.seconds = seconds, .fast = io.KeyShift, .slow = io.KeyAlt};
  const glm::dvec2 pulled(double(io.MouseDelta.x), double(io.MouseDelta.y));
  // Ignores the mouse motion of the frame in which a button goes down: that motion came before the press.
  const auto holds = [&](ImGuiMouseButton button) {
    return !io.WantCaptureMouse && ImGui::IsMouseDown(button) && !ImGui::IsMouseClicked(button);
  };
  if (holds(ImGuiMouseButton_Right)) input.look = pulled;
  if (!io.WantCaptureMouse && ImGui::IsMouseClicked(ImGuiMouseButton_Middle))
    item.pickPixel = glm::dvec2(double(io.MousePos.x * io.DisplayFramebufferScale.x),
                                double(io.MousePos.y * io.DisplayFramebufferScale.y));
  if (holds(ImGuiMouseButton_Middle)) input.orbit = pulled;
  if (!io.WantCaptureMouse && io.KeyCtrl)
    item.navigation.fovY = std::clamp(item.navigation.fovY * std::exp(-0.1 * double(io.MouseWheel)), 0.1, 2.6);
  else if (!io.WantCaptureMouse)
    input.wheel = double(io.MouseWheel);
  if (io.KeyCtrl || panelUsesKeyboard(viewer)) return input;
  const auto down = [&](int key) { return keys.isDown(key) && !viewer.shortcutKeys.contains(key) ? 1.0 : 0.0; };
  // Arrows navigate inside a panel as soon as the panel has been clicked.
  constexpr double kArrow = 400;  // px/s
  if (!ImGui::IsWindowFocused(ImGuiFocusedFlags_AnyWindow))
    input.look += kArrow * seconds *
                  glm::dvec2(down(GLFW_KEY_RIGHT) - down(GLFW_KEY_LEFT), down(GLFW_KEY_DOWN) - down(GLFW_KEY_UP));
  input.move = {down(GLFW_KEY_D) - down(GLFW_KEY_A), down(GLFW_KEY_E) - down(GLFW_KEY_Q),
                down(GLFW_KEY_S) - down(GLFW_KEY_W)};
  return input;
}

// Returns true for inputs that end the playback of a camera path.
bool endsPlayback(const NavigationInput& input) {
  return input.move != glm::dvec3(0) || input.look != glm::dvec2(0) || input.orbit != glm::dvec2(0);
}

// Returns true if a flight, a panel or a key moved the camera since the path was last shown.
bool movedByUser(const OpenItem& item) {
  const Navigation& navigation = item.navigation;
  return navigation.flight || navigation.pose.position != item.pathPose.position ||
         navigation.pose.rotation != item.pathPose.rotation || navigation.fovY != item.pathFovY;
}

// Returns true while the playback continues.
bool advancePlayback(OpenItem& item, double seconds) {
  const double first = item.cameraPath.keys.front().time, whole = item.cameraPath.keys.back().time - first;
  const Camera shown = cameraAt(item.cameraPath, first + item.pathTime);
  item.navigation.pose = item.pathPose = shown.pose;
  item.navigation.fovY = item.pathFovY = 2 * std::atan(0.5 * shown.intrinsics.height / shown.intrinsics.fy);
  item.navigation.velocity = glm::dvec3(0);
  item.playingPath = item.pathTime < whole;  // the last key itself is shown before the end
  const double next = item.pathTime + seconds;
  item.pathTime = item.loopingPath && whole > 0 ? std::fmod(next, whole) : next;
  return item.playingPath;
}

void goTo(OpenItem& item, std::optional<std::size_t> viewpoint) {
  if (viewpoint) item.flyToViewpoint(*viewpoint);
}

void cycleOverlays(OpenItem& item, bool back) {
  if (!item.scene) return;
  const std::size_t n = kOverlays.size();
  item.settings.overlay = kOverlays[(std::size_t(item.settings.overlay) + (back ? n - 1 : 1)) % n].overlay;
  item.changed = true;
}

void cycleComposition(OpenItem& item) {
  if (!item.scene) return;
  item.settings.composition = next(item.settings.composition);
  item.changed = true;
}

// Handles keys that act on the open scene.
void handleItemKey(Viewer& viewer, OpenItem& item, const KeyPress& press) {
  switch (press.key) {
    case GLFW_KEY_O:
      return cycleOverlays(item, press.shift);
    case GLFW_KEY_C:
      return cycleComposition(item);
    case GLFW_KEY_RIGHT_BRACKET:
      return goTo(item, nextCamera(item.poses(), item.navigation.pose, 1));
    case GLFW_KEY_LEFT_BRACKET:
      return goTo(item, nextCamera(item.poses(), item.navigation.pose, -1));
    case GLFW_KEY_BACKSPACE:
      return goTo(item, nearestCamera(item.poses(), item.navigation.pose));
    case GLFW_KEY_L:
      item.navigation.pose = levelled(item.navigation.pose, item.navigation.up);
      item.changed = true;
      return;
    case GLFW_KEY_G:
      item.showGraph = !item.showGraph;
      item.changed = true;
      return;
    case GLFW_KEY_K:
      return item.addPathKey();
    case GLFW_KEY_J:
      return item.showCameraPath();
    case GLFW_KEY_B:
      item.bounded = !item.bounded;
      return;
    case GLFW_KEY_SPACE:
      item.playing = item.video && !item.playing;
      return;
    case GLFW_KEY_P:
      viewer.screenshotRequested = true;
      return;
    default:
      return;
  }
}

void handleControlKey(Viewer& viewer, int key) {
  constexpr float kStep = 1.25f;
  const std::size_t n = viewer.items.size();
  switch (key) {
    case GLFW_KEY_O:
      viewer.showOpenDialog = true;
      return;
    case GLFW_KEY_W:
      return viewer.closeCurrent();
    case GLFW_KEY_S:
      viewer.savePathRequested = true;
      return;
    case GLFW_KEY_M:
      viewer.videoRequested = true;
      return;
    case GLFW_KEY_C:
      viewer.copyRequested = true;
      return;
    case GLFW_KEY_V:
      viewer.pasteRequested = true;
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

void handleKeyPress(Viewer& viewer, const KeyPress& press) {
  if (press.control) viewer.shortcutKeys.insert(press.physicalKey);
  if (press.key == GLFW_KEY_F1) viewer.showHelp = !viewer.showHelp;
  if (press.key == GLFW_KEY_F2) viewer.showInterface = !viewer.showInterface;
  if (press.key == GLFW_KEY_F6) viewer.focusNextPanel = viewer.showInterface = true;
  if (press.control && press.key == GLFW_KEY_Q) viewer.closeRequested = true;
  if (ImGui::GetIO().WantTextInput || viewer.showOpenDialog) return;
  if (press.control) return handleControlKey(viewer, press.key);
  if (panelUsesKeyboard(viewer)) return;
  if (press.key >= GLFW_KEY_1 && press.key <= GLFW_KEY_9) {
    viewer.activePage = std::size_t(press.key - GLFW_KEY_1);
    viewer.showInterface = true;
  }
  if (OpenItem* item = viewer.item()) handleItemKey(viewer, *item, press);
}

}  // namespace

std::span<const KeyHelp> keyHelp() {
  return kKeys;
}

void press(Viewer& viewer, std::span<const KeyPress> keys, const FrameKeys& down) {
  std::erase_if(viewer.shortcutKeys, [&](int key) { return !down.isDown(key); });
  for (const KeyPress& key : keys) handleKeyPress(viewer, key);
}

bool control(Viewer& viewer, OpenItem& item, const FrameKeys& keys, double seconds) {
  const Pose before = item.navigation.pose;
  const double fovBefore = item.navigation.fovY;
  const NavigationInput input = readNavigationInput(viewer, item, keys, seconds);
  if (!ImGui::GetIO().WantCaptureMouse && ImGui::IsAnyMouseDown()) ImGui::SetWindowFocus(nullptr);
  item.playingPath = item.playingPath && !endsPlayback(input) && !movedByUser(item);
  bool goesOn = item.playingPath ? advancePlayback(item, seconds)
                                 : navigate(item.navigation, input, item.bounded ? &item.bounds : nullptr);
  bool changed = goesOn || item.navigation.pose.position != before.position ||
                 item.navigation.pose.rotation != before.rotation || item.navigation.fovY != fovBefore;
  if (item.video && item.playing) {
    item.time = std::fmod(item.time + seconds, item.video->duration());
    changed = true;
  }
  return std::exchange(item.changed, false) || changed;
}

}  // namespace ibr::app
