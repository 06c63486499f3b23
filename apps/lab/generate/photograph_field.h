// SPDX-License-Identifier: Apache-2.0
// A scene of any number of photographs, each with a texture of its own, and cells with a mesh of their own: to measure
// planning and streaming at scale. The scene is in memory; textures are files.
//
// Photographs stand a metre apart on a square grid, between a floor and a ceiling, and look in one direction. Each
// square of the grid has two cells of three photographs. Meshes have parallax: 5,202 triangles on floor and ceiling.
#pragma once

#include <filesystem>

#include "ibr/image.h"
#include "ibr/scene.h"

namespace ibr {

/// `side`: photographs along each side of the grid, >= 2. `size`: their width and height, px. Node n has the texture
/// file `n`.ktx2 in `folder`, which becomes the scene's folder; nothing is read or written.
Scene photographField(int side, int size, const std::filesystem::path& folder);

/// Renders a photograph of the field: RGB.
Image8 fieldPhotograph(const Scene& scene, std::size_t node);

}  // namespace ibr
