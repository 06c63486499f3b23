// SPDX-License-Identifier: Apache-2.0
// The program `ibr-vr` on a scripted headset: what its tests share.
#pragma once

#include <catch2/catch.hpp>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "apps/support/tiny_scene.h"
#include "ibr/camera.h"
#include "xr_setup.h"

namespace ibr::test {

/// A head in the room that has eyes of its own, with fields of view unlike each other, and no hands that would be seen.
RemoteState lookingAhead(glm::dvec3 head = {0, 1.6, 0});

/// ibr-vr on the tiny scene with validation and the report on stdout, without a window.
class Visitor {
 public:
  explicit Visitor(XrSetup& setup, std::vector<std::string> more = {}, std::vector<std::string> environment = {});

  XrSetup& setup() { return setup_; }
  RunningProgram& program() { return program_; }
  /// Moves the headset; it must arrive.
  void move(const RemoteState& state);
  /// Waits for so many frames more; the program must live to show them.
  void pass(int frames);
  /// Waits until the scene is shown: its first cells are drawn, and the fade that it comes with is over.
  void waitForScene();

  /// Ctrl-C, then the end: the exit code that says so, and no messages of validation.
  nlohmann::json leave();
  /// The end by itself.
  Outcome finish();

 private:
  XrSetup& setup_;
  RunningProgram program_;
};

/// Frames of the record that show something.
std::vector<nlohmann::json> shownFrames(const XrSetup& setup);

/// The left and right eye's last pictures in a folder (--screenshot-every).
std::array<std::filesystem::path, 2> lastPictures(const std::filesystem::path& folder);
/// The views in the world that pictures tell.
std::array<Camera, 2> viewsIn(const std::array<std::filesystem::path, 2>& pictures);

/// What `ibr render --stereo` draws of the left eye's picture NAME_l.png and its partner beside it, on the same device
/// and with the same floor.
std::array<Image8, 2> drawnAgain(const XrSetup& setup, const std::filesystem::path& left,
                                 const std::filesystem::path& folder, const std::vector<std::string>& more);

}  // namespace ibr::test
