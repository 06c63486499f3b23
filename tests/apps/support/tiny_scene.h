// SPDX-License-Identifier: Apache-2.0
// A photograph set of three small pictures, as a user would bring it, and the scene that `ibr build` makes of it.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "ibr/camera.h"

namespace ibr::test {

struct NamedCamera {
  std::string name;
  Camera camera;
};

/// A COLMAP text model; without points where there are no tracks.
void writeColmapModel(const std::filesystem::path& folder, const std::vector<NamedCamera>& cameras);

struct TinySet {
  std::filesystem::path photographs;  // a/0.png, a/1.png, b/2.png, and sparse/ with the model
  std::vector<NamedCamera> cameras;
  std::filesystem::path truth;  // images/between.png and sparse/: a view between the photographs, as it really looks
};

/// Writes the set below `folder`.
TinySet makeTinySet(const std::filesystem::path& folder);

/// Five photographs side by side, row0.png … row4.png, and sparse/ with the model, in `folder`.
std::vector<NamedCamera> makeRow(const std::filesystem::path& folder);

/// A scene made of the tiny set, built once by the program; it lives as long as the test program.
const std::filesystem::path& tinyScene();
const TinySet& tinySet();

/// The folder that both are in.
const std::filesystem::path& tinyFolder();

}  // namespace ibr::test
