// SPDX-License-Identifier: Apache-2.0
// A harmonised model made in code: a body with folds that hide parts of it, photographed from around, with photographs
// that disagree by a known amount.
//
// Camera i shows at a surface point x the solid texture's colour at x + u_i, u_i a small vector of its own. What camera
// j shows at vertex v is therefore found in picture i where x + u_i = v + u_j: the planted complement is the projection
// of v + u_j − u_i, less that of v.
#pragma once

#include <cstdint>
#include <vector>

#include "ibr/htm.h"

namespace ibr::test {

struct BumpyOptions {
  int cameras = 6;  // on a ring around it, high and low in turn
  int width = 160, height = 120;
  int longitudes = 24, latitudes = 14;  // 2 · longitudes · (latitudes − 1) triangles
  double disagreement = 0.01;           // length of u_i; the body's radius is about 0.5
  double distance = 2.5;                // of the cameras from the middle
  glm::dvec3 middle{0.0};
};

struct BumpyModel {
  HtmModel model;
  std::vector<HtmPicture> pictures;
  std::vector<glm::dvec3> offsets;  // u_i
  BumpyOptions options;

  HtmPictureSource source() const {
    return [this](const HtmModel&, std::size_t camera) { return pictures[camera]; };
  }
};

BumpyModel bumpyModel(const BumpyOptions& options = {});

/// A camera on the ring at an angle (radians; camera i's is 2π i / n), looking at the middle.
Camera ringCamera(const BumpyOptions& options, double angle, double elevation = 0.2);

/// RGB in [0.1, 0.9] of the solid texture at a point relative to the middle.
glm::dvec3 solidColour(glm::dvec3 at);

/// What a camera sees at each pixel's centre.
struct SurfaceHit {
  std::int64_t triangle = -1;  // none
  glm::dvec3 share{0.0};       // barycentric, perspective-correct
  double inverseDepth = 0;     // along the viewing axis
};
std::vector<SurfaceHit> surfaceHits(const TriangleMesh& mesh, const Camera& camera);
glm::dvec3 pointOf(const TriangleMesh& mesh, const SurfaceHit& hit);

}  // namespace ibr::test
