// SPDX-License-Identifier: Apache-2.0
// A set of three small photographs as a user provides it, and the scene that `ibr build` makes from the set.
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

/// Writes a COLMAP text model. Without tracks, the model has no points.
void writeColmapModel(const std::filesystem::path& folder, const std::vector<NamedCamera>& cameras);

struct TinySet {
  std::filesystem::path photographs;  // a/0.png, a/1.png, b/2.png, and sparse/ with the model
  std::vector<NamedCamera> cameras;
  std::filesystem::path truth;  // images/between.png and sparse/: a generated view between the photographs
};

/// Writes the set below `folder`.
TinySet makeTinySet(const std::filesystem::path& folder);

/// Writes five photographs side by side, row0.png … row4.png, and sparse/ with the model, into `folder`.
std::vector<NamedCamera> makeRow(const std::filesystem::path& folder);

/// Scene built from the tiny set, once, by the program. The scene exists until the test program ends.
const std::filesystem::path& tinyScene();
const TinySet& tinySet();

/// Folder of both.
const std::filesystem::path& tinyFolder();

}  // namespace ibr::test
