// SPDX-License-Identifier: Apache-2.0
// Generates scenes with exact truth: textured planes, seen by given cameras, with a morphing mesh whose every number is
// computed from the geometry. For tests and for `ibr-lab synth`.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "ibr/image.h"
#include "ibr/scene.h"

namespace ibr {

/// A rectangle with a band-limited texture: wavelengths `wavelength` to 4·`wavelength`, values within 10 to 245.
/// Visible from both sides.
struct TexturedPlane {
  glm::dvec3 origin{0.0};           // the rectangle's centre, world
  glm::dvec3 u{1.0, 0.0, 0.0};      // unit, along its width
  glm::dvec3 v{0.0, 1.0, 0.0};      // unit, perpendicular to u
  double extentU = 1, extentV = 1;  // width and height, world units
  std::uint64_t seed = 1;           // of the texture
  double wavelength = 0.1;          // shortest of the texture, world units
};

struct SyntheticOptions {
  std::vector<Camera> cameras;
  std::vector<TexturedPlane> planes;
  std::vector<std::vector<std::uint32_t>> cells;  // member lists; empty: one cell of all cameras
  int gridStep = 32;                              // px between vertices in the image of a cell's first member
  double surfaceStep = 0;   // > 0: vertices lie on a grid over the planes instead, at most this far apart, world units
  bool atInfinity = false;  // planes are a backdrop around the cameras' mean centre, seen the same way from anywhere
  int samplesPerAxis = 4;   // of the photographs
};

struct SyntheticScene {
  Scene scene;                      // nodes "view0", "view1", …; cells of tier 0, uncertainty 0, ecc 1
  std::vector<Image8> photographs;  // RGB, one per node
  std::vector<TexturedPlane> planes;
  std::optional<glm::dvec3> centreOfInfinity;  // set by SyntheticOptions::atInfinity
};

/// Vertices lie on a pixel grid of the first member, at points where the plane is the first surface for every member.
/// No triangle crosses planes or covers a nearer surface (checked pixel by pixel). With surfaceStep the vertices lie on
/// the planes, and quads that all members see are kept (checked at 5 × 5 points): around panoramas in a room the mesh
/// closes. ρ is the inverse of the mean distance. Throws Error{invalidInput} for a cell without 2 to 4 members, a grid
/// step below 1, over 10 million quads on a plane, and a plane with invalid numbers (named in the message).
SyntheticScene makeScene(const SyntheticOptions& options);

/// The six walls of a box, seen from inside; seeds count from `seed`.
std::vector<TexturedPlane> roomPlanes(glm::dvec3 low, glm::dvec3 high, double wavelength, std::uint64_t seed = 1);

/// Renders a camera's photograph: RGB, the mean of samplesPerAxis² samples per pixel (of display-encoded values, which
/// renderers here blend), black without a plane.
Image8 renderTruth(const SyntheticScene& scene, const Camera& camera, int samplesPerAxis = 4);

/// One channel: distance along the viewing axis (equirectangular: along the ray) of the surface at pixel centres, world
/// units; infinity without a plane, or for a scene at infinity.
ImageF renderDepth(const SyntheticScene& scene, const Camera& camera);

/// Distance to the first plane along a ray, in lengths of `direction`; nullopt if there is none.
std::optional<double> distanceAlong(const SyntheticScene& scene, glm::dvec3 from, glm::dvec3 direction);

/// RGB in [10, 245] of the texture at (along u, along v) from the rectangle's centre, world units.
glm::dvec3 textureColour(const TexturedPlane& plane, glm::dvec2 at);

}  // namespace ibr
