// SPDX-License-Identifier: Apache-2.0
// A photograph as the vote and the gather read it: where it sees a point of the view, its own depth there, its colour.
#pragma once

#include <optional>
#include <vector>

#include "ibr/camera.h"
#include "ibr/image.h"
#include "reference/texture_sampling.h"

namespace ibr::reference {

/// A photograph that votes and that colours are gathered from. Images are not owned.
struct Candidate {
  Camera camera;
  double weight = 1;    // as a whole, 0 to 1
  double distance = 0;  // from the middle of the views, spacings of the capture
  double step = 0;      // ρ that moves a point by 1 px at half the photograph's size over the spacing, > 0
  double residual = 0;  // ρ that moves a point by the median reprojection residual over the spacing
  const std::vector<Image8>* levels = nullptr;  // RGBA mip levels; alpha is the mask
  bool cubic = false;                           // TextureFilter::bicubic
  bool masked = false;                          // alpha may be below 255
  const ImageF* depth = nullptr;                // ρ / depthScale, consensus; covers the photograph
  double depthScale = 1;                        // 1 / world unit
  glm::dvec3 gain{1};                           // of linear light, red, green, blue
};

/// Pixels a radian in the middle of a photograph: fx, or width / 2π of a panorama.
double focalPx(const Intrinsics& intrinsics);

/// Bilinear in an alpha channel: 0 to 1. `pixel`: of the finest level.
double alphaAt(const Candidate& candidate, glm::dvec2 pixel);

/// A candidate as a pinhole view reads it. The candidate's images must outlive it.
class PhotographSampler {
 public:
  PhotographSampler(const Camera& view, const Candidate& candidate);

  /// The point at ρ (along the view's axis, 0 = at infinity) of a pixel lies in the direction ray(pixel) from the view,
  /// ray(pixel) + ρ·shift() from the photograph, in the photograph's axes.
  glm::dvec3 ray(glm::dvec2 pixel) const;
  const glm::dvec3& shift() const { return shift_; }

  /// Where a direction is seen; nullopt outside the photograph, or behind it.
  std::optional<glm::dvec2> pixel(const glm::dvec3& direction) const;

  /// ρ in the photograph of a point that lies at ρ in the view: along its axis, of a panorama along the ray.
  double inverseDepth(const glm::dvec3& direction, double viewInverseDepth) const;

  /// ρ of the photograph's own surface: bilinear in its depth map.
  double ownInverseDepth(glm::dvec2 pixel) const;

  /// Its consensus, likewise; 1 where the map has ρ alone.
  double ownConsensus(glm::dvec2 pixel) const;

  /// Distance to the photograph's border as a share of the width along which it fades: 0 to 1. 1 of a panorama.
  double border(glm::dvec2 pixel) const;

  /// Pixels of the photograph a pixel of the view.
  double resolution(const glm::dvec3& ray, const glm::dvec3& direction) const;

  /// Colour with the photograph's gain, 0 to 1 where the gain is 1; alpha without. `footprint`: texels a pixel.
  Texel colour(glm::dvec2 pixel, double footprint) const;

  const Candidate& candidate() const { return *candidate_; }

 private:
  bool isPanorama() const { return candidate_->camera.intrinsics.model == CameraModel::equirectangular; }

  const Candidate* candidate_;
  Intrinsics view_;
  glm::dmat3 turn_;
  glm::dvec3 shift_;
};

}  // namespace ibr::reference
