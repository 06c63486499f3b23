// SPDX-License-Identifier: Apache-2.0
// A simulated person in a headset who opens the menu of ibr-vr and presses its items. The frame record gives the
// panel's pose; the same panel without a headset gives the positions of its items.
#pragma once

#include "vr/menu/menu_panel.h"
#include "vr_harness.h"

namespace ibr::test {

/// A recorded pose, or the pose of a recorded view.
Pose recordedPose(const nlohmann::json& pose);

class MenuUser {
 public:
  /// Starts on the tiny scene and `others` further scenes. `more`: additional command-line words.
  explicit MenuUser(const std::string& faults = "", std::vector<std::string> more = {}, std::size_t others = 0);

  XrSetup& setup() { return setup_; }
  Visitor& visitor() { return visitor_; }
  RemoteState& state() { return state_; }
  void send() { visitor_.move(state_); }
  /// Waits until `come` returns true. Fails the test if the program ends.
  void waitUntil(const std::function<bool()>& come);
  bool says(const std::string& text) { return visitor_.program().err().find(text) != std::string::npos; }

  /// Presses and releases the menu button of the right hand.
  void pressMenuButton();
  /// The menu's layer in the last frame; null while the menu is closed.
  nlohmann::json panel() const;
  /// Points the right hand at an item of the menu's open page, or of no page; `part`: as shares of the item's sides.
  /// Then presses and releases.
  void press(const std::string& name, glm::dvec2 part = {0.5, 0.5});
  /// Presses exit and confirms with a second press. The program then ends by itself.
  Outcome exit();
  void pressOn(const std::string& page, const std::string& name) { press(page), press(name); }

  /// World views of both eyes, from images taken after all sent input.
  std::array<Camera, 2> eyes();
  /// Midpoint of both eyes.
  glm::dvec3 head();

 private:
  void pointAt(const std::string& name, glm::dvec2 part);

  XrSetup setup_;
  TemporaryFolder pictures_;
  RemoteState state_ = lookingAhead();
  std::size_t scenes_;
  Visitor visitor_;
};

}  // namespace ibr::test
