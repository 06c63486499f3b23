// SPDX-License-Identifier: Apache-2.0
// Drives the program `ibr-viewer` with keys and the mouse. Shared by its tests.
#pragma once

#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <functional>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "apps/support/run_program.h"
#include "apps/support/tiny_scene.h"
#include "apps/support/virtual_display.h"
#include "apps/support/x11_window.h"
#include "base/file.h"
#include "ibr/metrics.h"
#include "io/image_file.h"
#include "support/htm_files.h"
#include "support/json.h"
#include "support/temporary_folder.h"

namespace ibr::test {

/// Runs the viewer without input, with the validation layer. Any message fails the test.
Outcome view(std::vector<std::string> arguments, std::vector<std::string> environment = {});

/// Waits until `what` returns true. Returns false after the time limit.
bool comes(const std::function<bool()>& what);

/// Waits until the last document is shown, according to the title.
void waitForPlace(const std::string& window);

/// The window's pixels after all motion has ended.
Image8 settledPixels(const std::string& window);

/// Runs the viewer and calls `act` with its window. Returns the viewer's report, printed on closing.
nlohmann::json whileViewing(std::vector<std::string> arguments,
                            const std::function<void(const std::string& window)>& act,
                            std::vector<std::string> environment = {});
/// Returns whether a device and a display are available.
bool canView();
glm::dvec3 positionOf(const nlohmann::json& place);
glm::dquat rotationOf(const nlohmann::json& place);
/// Runs xdotool with the arguments, then waits for the frames in which the program acts and shows the result.
void act(const std::vector<std::string>& arguments);
void hold(const char* key, double seconds);

/// Records two keys of a path, and takes a screenshot at the first.
void recordPath();
void pressAll(const std::vector<std::string>& keys);

/// Writes a small harmonised model to `folder`/model.
void makeModel(const TemporaryFolder& folder);

/// Compares windows of 640×480 px outside the side panel, its hints, and messages.
bool sameBesidePanel(const Image8& window, const Image8& picture);
bool hasFfmpeg();

}  // namespace ibr::test
