// SPDX-License-Identifier: Apache-2.0
// Generates a harmonised model: a body with folds that hide parts of its surface, cameras on a ring around it, and
// photographs that disagree by a known amount.
//
// At a surface point x, camera i shows the solid texture's colour at x + u_i, where u_i is a small vector of camera i.
// Picture i therefore shows the colour that camera j shows at vertex v where x + u_i = v + u_j. The planted
// complement is the projection of v + u_j − u_i minus the projection of v.
#pragma once

#include <cstdint>
#include <vector>

#include "ibr/htm.h"

namespace ibr::test {

struct BumpyOptions {
  int cameras = 6;  // on a ring around the body, alternately high and low
  int width = 160, height = 120;
  int longitudes = 24, latitudes = 14;  // 2 · longitudes · (latitudes − 1) triangles
  double disagreement = 0.01;           // length of u_i, scene units; the body's radius is about 0.5
  double distance = 2.5;                // from the cameras to the middle, scene units
  glm::dvec3 middle{0.0};
};

struct BumpyModel {
  HtmModel model;
  std::vector<HtmImage> pictures;
  std::vector<glm::dvec3> offsets;  // u_i
  BumpyOptions options;

  HtmImageSource source() const {
    return [this](const HtmModel&, std::size_t camera) { return pictures[camera]; };
  }
};

BumpyModel bumpyModel(const BumpyOptions& options = {});

/// Returns a camera on the ring at `angle` (radians; camera i has 2π i / n) that looks at the middle.
Camera ringCamera(const BumpyOptions& options, double angle, double elevation = 0.2);

/// Returns the solid texture's colour, RGB in [0.1, 0.9], at a point relative to the middle.
glm::dvec3 solidColour(glm::dvec3 at);

/// Surface point that a camera sees at a pixel's centre.
struct SurfaceHit {
  std::int64_t triangle = -1;  // −1: none
  glm::dvec3 share{0.0};       // barycentric, perspective-correct
  double inverseDepth = 0;     // along the viewing axis
};
std::vector<SurfaceHit> surfaceHits(const TriangleMesh& mesh, const Camera& camera);
glm::dvec3 pointOf(const TriangleMesh& mesh, const SurfaceHit& hit);

}  // namespace ibr::test
