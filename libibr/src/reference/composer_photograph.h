// SPDX-License-Identifier: Apache-2.0
// A photograph as sampled by the vote and the gather: projection of view points, own depth there, and colour.
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
  double weight = 1;    // of the photograph, 0 to 1
  double distance = 0;  // from the midpoint of the views, in capture spacings
  double step = 0;      // ρ that moves a point by 1 px at half the photograph's size over the spacing, > 0
  double residual = 0;  // ρ that moves a point by the median reprojection residual over the spacing
  const std::vector<Image8>* levels = nullptr;  // RGBA mip levels; alpha is the mask
  bool cubic = false;                           // TextureFilter::bicubic
  bool masked = false;                          // alpha may be below 255
  const ImageF* depth = nullptr;                // ρ / depthScale, consensus; covers the photograph
  double depthScale = 1;                        // 1 / world unit
  glm::dvec3 gain{1};                           // of linear light, red, green, blue
};

/// Pixels per radian in the middle of a photograph: fx, or width / 2π for a panorama.
double focalPx(const Intrinsics& intrinsics);

/// Samples a candidate for a pinhole view. The candidate's images must outlive the sampler.
class PhotographSampler {
 public:
  PhotographSampler(const Camera& view, const Candidate& candidate);

  /// A pixel's point at ρ (along the view's axis, 0 = at infinity) lies in direction ray(pixel) from the view. From the
  /// photograph, its direction is ray(pixel) + ρ·shift(). Both are in the photograph's axes.
  glm::dvec3 ray(glm::dvec2 pixel) const;
  const glm::dvec3& shift() const { return shift_; }

  /// Pixel of a direction; nullopt outside the photograph, or behind it.
  std::optional<glm::dvec2> pixel(const glm::dvec3& direction) const;

  /// Converts ρ in the view to ρ in the photograph: along its axis, for a panorama along the ray.
  double inverseDepth(const glm::dvec3& direction, double viewInverseDepth) const;

  /// ρ of the photograph's own surface: bilinear in its depth map.
  double ownInverseDepth(glm::dvec2 pixel) const;

  /// Consensus of the photograph's own surface, likewise; 1 if the map only has ρ.
  double ownConsensus(glm::dvec2 pixel) const;

  /// Distance to the photograph's border relative to the width of its fade: 0 to 1; 1 for a panorama.
  double border(glm::dvec2 pixel) const;

  /// Pixels of the photograph per pixel of the view.
  double resolution(const glm::dvec3& ray, const glm::dvec3& direction) const;

  /// Colour with the photograph's gain, 0 to 1 if the gain is 1; alpha without. `footprint`: texels per pixel.
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
