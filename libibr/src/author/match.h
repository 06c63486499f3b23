// SPDX-License-Identifier: Apache-2.0
// A dense match of 2 to 4 posed photographs ([T] §2.4.1 asks for one; ours is a plane sweep, since the poses are
// known).
//
//   1. mean frame; inverse-depth range and dominant planes from the tracks
//   2. plane sweep and semi-global matching at half resolution, cleaned, foregrounds trimmed, brought to full resolution
//   3. gate: inside all members' pictures, alike in all of them, and hidden from none by what stands before it
//   4. where the poses are estimates: what optical flow finds between the members, warped to the frame, is added to the
//      matches; too large a flow shuts the gate
#pragma once

#include <cstddef>
#include <glm/gtc/type_precision.hpp>
#include <glm/vec2.hpp>
#include <optional>
#include <span>
#include <vector>

#include "ibr/author.h"
#include "ibr/image.h"

namespace ibr {

/// Members of a cell at most, hence views of a match: the corners of a tetrahedron.
inline constexpr std::size_t kMostMembers = 4;

/// A member's photograph at the size that is matched; the intrinsics are those of that size.
struct MatchView {
  Camera camera;
  Image8 picture;    // RGB
  Image8 mask = {};  // author/masks.h, of the picture's size; or empty
};

struct MatchOptions {
  bool refine = false;  // step 4
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

/// `points` of the world that the members see give the sweep its range and planes. Precondition: 2 to 4 views. Throws
/// Error{invalidInput} where no point lies in front of the mean frame.
DenseMatch matchViews(std::span<const MatchView> views, std::span<const glm::dvec3> points,
                      const MatchOptions& options = {});

}  // namespace ibr
