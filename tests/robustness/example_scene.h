// SPDX-License-Identifier: Apache-2.0
// A small scene with every feature of the file format, and its files.
#pragma once

#include <filesystem>

#include "ibr/scene.h"

namespace ibr::test {

/// Pinholes of four sizes and a panorama, far from the origin; cells of 2, 3 and 4 members with both tiers and points
/// at infinity, one without triangles and one without points; a backdrop with evidence; a depth texture; settings and a
/// geographic origin.
Scene exampleScene();

/// Writes exampleScene with its photographs and textures into `folder`.
void writeExampleScene(const std::filesystem::path& folder);

}  // namespace ibr::test
