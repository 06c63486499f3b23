// SPDX-License-Identifier: Apache-2.0
// Runs the program `ibr-vr` on a scripted headset. Shared by its tests.
#pragma once

#include <catch2/catch.hpp>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "apps/support/tiny_scene.h"
#include "ibr/camera.h"
#include "support/json.h"
#include "xr_setup.h"

namespace ibr::test {

/// A head in the room with its own eyes, whose fields of view differ, and with invisible hands.
RemoteState lookingAhead(glm::dvec3 head = {0, 1.6, 0});

/// Runs ibr-vr on the tiny scene, with validation, with the report on stdout, and without a window.
class Visitor {
 public:
  explicit Visitor(XrSetup& setup, std::vector<std::string> more = {}, std::vector<std::string> environment = {});

  XrSetup& setup() { return setup_; }
  RunningProgram& program() { return program_; }
  /// Moves the headset. Fails the test if the state does not arrive.
  void move(const RemoteState& state);
  /// Waits for the given number of frames. Fails the test if the program ends before.
  void pass(int frames);
  /// Waits until the scene is shown: its first cells are drawn, and its fade-in is over.
  void waitForScene();

  /// Sends Ctrl-C and waits for the end. Checks the exit code, and that there are no validation messages.
  nlohmann::json leave();
  /// Waits for the program's own end.
  Outcome finish();

 private:
  XrSetup& setup_;
  RunningProgram program_;
};

/// Frames of the record that have layers.
std::vector<nlohmann::json> shownFrames(const XrSetup& setup);

/// The last images of the left and right eye in a folder (--screenshot-every).
std::array<std::filesystem::path, 2> lastPictures(const std::filesystem::path& folder);
/// World views stored in the images' metadata.
std::array<Camera, 2> viewsIn(const std::array<std::filesystem::path, 2>& pictures);

/// Renders the views of the left eye's image NAME_l.png and of the right eye's image with `ibr render --stereo`, on the
/// same device and with the same floor.
std::array<Image8, 2> drawnAgain(const XrSetup& setup, const std::filesystem::path& left,
                                 const std::filesystem::path& folder, const std::vector<std::string>& more);

}  // namespace ibr::test
