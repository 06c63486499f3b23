// SPDX-License-Identifier: Apache-2.0
// The views of a match and its result: types shared by matchers, features and meshes.
#pragma once

#include <cstddef>
#include <glm/gtc/type_precision.hpp>
#include <glm/vec2.hpp>
#include <optional>
#include <vector>

#include "ibr/camera.h"
#include "ibr/image.h"

namespace ibr {

/// Max members of a cell, i.e. views of a match: the corners of a tetrahedron.
inline constexpr std::size_t kMaxMembers = 4;

/// A member's photograph at the matched size; the intrinsics are for that size.
struct MatchView {
  Camera camera;
  Image8 picture;    // RGB
  Image8 mask = {};  // author/photographs/masks.h, of the image's size; or empty
};

/// Sub-pixel positions of mesh vertices, where the matcher itself chooses them.
struct MatchedVertices {
  std::vector<glm::vec2> frame;                 // px of the frame
  std::vector<double> inverseDepth;             // along the frame's axis
  std::vector<std::vector<glm::vec2>> matched;  // for each view: px of its image
  std::vector<glm::u16vec4> planes;             // that contain each vertex, as MorphMesh::planes; empty: unknown
};

/// Dense match. All images have the frame's size; entry (x, y) is for the pixel's centre.
struct DenseMatch {
  Camera frame;
  ImageF inverseDepth;           // along the frame's axis
  float inverseDepthStep = 0;    // one level of the sweep
  std::vector<ImageF> position;  // for each member: 2 channels, px in its image; outside the image where good is 0
  Image8 good;                   // 1 channel: 1 where all unmasked members agree, at least two
  std::vector<Image8> seen;      // for each member: 1 where it sees the point, with texture that others share
  bool refined = false;          // by step 4: positions differ slightly from those of inverseDepth
  bool depthKnown = true;        // positions were computed from inverseDepth, not the reverse
  std::optional<MatchedVertices> vertices;  // chosen by the matcher; else by the quadtree
};

}  // namespace ibr
