// SPDX-License-Identifier: Apache-2.0
// Somebody in a headset who opens the menu of ibr-vr and presses what is on it: the panel is where the record of frames
// says that it is, and its parts are where the same panel without a headset has them.
#pragma once

#include "vr/menu/menu_panel.h"
#include "vr_harness.h"

namespace ibr::test {

/// A pose or a view's pose as the record has it.
Pose recordedPose(const nlohmann::json& pose);

class MenuUser {
 public:
  /// On the tiny scene and as many `others` as `more` names.
  explicit MenuUser(const std::string& faults = "", std::vector<std::string> more = {}, std::size_t others = 0);

  XrSetup& setup() { return setup_; }
  Visitor& visitor() { return visitor_; }
  RemoteState& state() { return state_; }
  void send() { visitor_.move(state_); }
  /// Waits until it answers true; the program must live.
  void waitUntil(const std::function<bool()>& come);
  bool says(const std::string& text) { return visitor_.program().err().find(text) != std::string::npos; }

  /// The button of the right hand, held and let go.
  void pressMenuButton();
  /// The layer of the menu in the last frame; null where it is closed.
  nlohmann::json panel() const;
  /// The right hand points into something on a page of the menu, which is open and shows that page, or none; `part` of
  /// its sides. Presses and lets go.
  void press(const std::string& name, glm::dvec2 part = {0.5, 0.5});
  /// Presses what asks for confirmation, and once more; the program then ends by itself.
  Outcome exit();
  void pressOn(const std::string& page, const std::string& name) { press(page), press(name); }

  /// Both eyes in the world, from pictures that were begun after all that was sent.
  std::array<Camera, 2> eyes();
  /// Between them.
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
