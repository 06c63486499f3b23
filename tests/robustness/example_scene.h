// SPDX-License-Identifier: Apache-2.0
// A small scene that has everything the file can hold, and its files.
#pragma once

#include <filesystem>

#include "ibr/scene.h"

namespace ibr::test {

/// Pinholes of four sizes and a panorama, far from the origin; cells of 2, 3 and 4 members with both tiers and points
/// at infinity, one without triangles and one without points; a backdrop with evidence; a depth
/// texture; settings and a geographic origin.
Scene exampleScene();

/// exampleScene with its photographs and textures, in `folder`.
void writeExampleScene(const std::filesystem::path& folder);

}  // namespace ibr::test
