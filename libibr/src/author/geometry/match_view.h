// SPDX-License-Identifier: Apache-2.0
// The views of a match and its result: types that matchers, features and meshes share.
#pragma once

#include <cstddef>
#include <glm/gtc/type_precision.hpp>
#include <glm/vec2.hpp>
#include <optional>
#include <vector>

#include "ibr/camera.h"
#include "ibr/image.h"

namespace ibr {

/// Members of a cell at most, hence views of a match: the corners of a tetrahedron.
inline constexpr std::size_t kMostMembers = 4;

/// A member's photograph at the size that is matched; the intrinsics are those of that size.
struct MatchView {
  Camera camera;
  Image8 picture;    // RGB
  Image8 mask = {};  // author/photographs/masks.h, of the picture's size; or empty
};

/// Where vertices of a mesh are to stand, sub-pixel.
struct MatchedVertices {
  std::vector<glm::vec2> frame;                 // px of the frame
  std::vector<double> inverseDepth;             // along its axis
  std::vector<std::vector<glm::vec2>> matched;  // of each view, px of its picture
  std::vector<glm::u16vec4> planes;             // that each lies on, as MorphMesh::planes; empty: not known
};

/// All pictures have the frame's size; pixel (x, y) stands for its centre.
struct DenseMatch {
  Camera frame;
  ImageF inverseDepth;           // along the frame's axis
  float inverseDepthStep = 0;    // one level of the sweep
  std::vector<ImageF> position;  // of each member: 2 channels, px in its picture; outside it where good is 0
  Image8 good;                   // 1 channel: 1 where all members agree that are not masked, two at least
  std::vector<Image8> seen;      // of each member: 1 where its texture is that of another one, and it sees the point
  bool refined = false;          // by step 4: positions are not quite what inverseDepth says
  bool depthKnown = true;        // positions follow from inverseDepth, not the other way round
  std::optional<MatchedVertices> vertices;  // where the matcher itself puts them; else the quadtree does
};

}  // namespace ibr
