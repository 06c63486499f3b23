// SPDX-License-Identifier: Apache-2.0
// The program `ibr-viewer`, driven by keys and the mouse as a person would: what its tests share.
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
#include "support/temporary_folder.h"

namespace ibr::test {

/// Runs the viewer by itself, with validation; it must have no reason to speak.
Outcome view(std::vector<std::string> arguments, std::vector<std::string> environment = {});

/// Whether it comes about before long.
bool comes(const std::function<bool()>& what);

/// The last place is on the screen, as the title says.
void waitForPlace(const std::string& window);

/// The window's pixels, once nothing moves in it.
Image8 settledPixels(const std::string& window);

/// What a person did, and what the viewer says about it when it has closed.
nlohmann::json whileViewing(std::vector<std::string> arguments,
                            const std::function<void(const std::string& window)>& act,
                            std::vector<std::string> environment = {});
/// Whether there are a device and a display.
bool canView();
glm::dvec3 positionOf(const nlohmann::json& place);
glm::dquat rotationOf(const nlohmann::json& place);
/// xdotool ARGUMENTS, and frames in which the program takes notice of them, acts on them and shows it.
void act(const std::vector<std::string>& arguments);
void hold(const char* key, double seconds);

/// Two keys of a path, and a picture from the first.
void recordPath();
void pressAll(const std::vector<std::string>& keys);

/// A small harmonised model, `folder`/model.
void makeModel(const TemporaryFolder& folder);

/// Of windows of 640×480, where neither the side panel with its hints nor a message lies.
bool sameBesidePanel(const Image8& window, const Image8& picture);
bool hasFfmpeg();

}  // namespace ibr::test
