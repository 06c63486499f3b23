// SPDX-License-Identifier: Apache-2.0
// Composes a view from photographs with depth, in double precision on the CPU: the reference implementation of
// Composition::gathered, also used to compare depth maps by the views that they give.
//
//   1. candidates  at most K photographs: FramePlan::photographs, or for depth maps a greedy choice by the sum, over
//                  a grid of rays and two depths, of √(Σ border / (.03 + angle))
//   2. layers      every candidate's mesh is drawn into the view at the vote's size: ρ, trust and consensus of the
//                  nearest surface (composer_layer.h)
//   3. vote        hypotheses of a pixel support each other within a tolerance t, weighted by trust and by nearness:
//                      u = trust(c) / (.3 + (d / b)²),   support(ρ) = Σ u (1 − (Δρ / t)²)
//                  the presence of a hypothesis is its share of the largest support, times max(1 − kernel / .25, 0)
//                  for each one of more support. From front to back, each shows presence · min(mean(a) / .9, 1) of
//                  the remaining share, up to all of it if nothing is behind. The two with the largest shares are
//                  the pixel's surfaces; pixels without a hypothesis get depth by pull and push (composer_vote.h)
//   4. gather      for each surface the N best candidates by
//                      w = r² · border · visibility / cost,   cost = .03 + angle + .001 d / b
//                  minus w of candidate N + 1, so that photographs enter and leave gradually (composer_gather.h). A
//                  surface is weighted by its opacity and by the agreement of its colours
//
// ρ is inverse depth along a camera's axis (for a panorama, along the ray), 1 / world unit; c, v and a:
// PhotographDepth. d: distance of a photograph from the midpoint of the views; b: capture spacing. The image is
// continuous in the camera, except where the second and the third surface change places.
//
// Departure: w is divided by s = smoothstep(0, .01, cost − .03), so that at its own pose a photograph is alone.
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "ibr/camera.h"
#include "ibr/gpu_scene.h"
#include "ibr/image.h"
#include "ibr/renderer.h"
#include "ibr/scene.h"
#include "reference/composer_layer.h"

namespace ibr::reference {

/// A composed view. Inverse depths are along the view's axis.
struct Composed {
  Image8 picture;             // RGBA; alpha as AlphaContent::tier: kTierConsistent where the depth is confirmed,
                              // kTierCompleted where it was completed, kTierFilled where it was filled in the view,
                              // 0 and black in holes
  ImageF colour;              // RGB of `picture` before rounding, 8-bit levels
  ImageF inverseDepth;        // of the surface with the largest weight
  ImageF opaqueInverseDepth;  // of the nearest surface of at least half opacity, as in a depth buffer
  ImageF deviation;           // one standard deviation of opaqueInverseDepth
  ImageF supportMargin;       // Surfaces::margin of the pixel's vote: near 0 where rounding decides which peak wins
};

/// Textures of a scene's photographs, by node, valid until the composition is done.
struct GatherTextures {
  std::function<const std::vector<Image8>&(std::size_t)> photograph;  // RGBA mip levels; alpha is the mask
  std::function<const ImageF&(std::size_t)> depth;                    // as Node::depthFile: red ρ / depthScale
  TextureFilter filter = TextureFilter::trilinear;                    // or bicubic
};

/// Composes a view of a plan with Composition::gathered from the plan's photographs. Throws Error{invalidInput} for a
/// RenderSettings::renderScale other than 1, a plan without a spacing, and colours or layers out of range. It also
/// throws for a photograph without evidence in its backdrop's mesh, without RGBA mip levels, or without a depth
/// texture. Memory: 24 K + 100 bytes per pixel of the vote, 28 bytes per pixel, and per thread 100 bytes per vertex of
/// one mesh.
Composed composeGathered(const Scene& scene, const FramePlan& plan, std::size_t view, const GatherTextures& textures,
                         int threads = 1);

/// Fills holes with colours from around them, marked kTierFilled, as a device does if RenderSettings::maxTier allows.
/// Depth does not change.
void fillColours(Composed& view);

/// A photograph with its depth. A pinhole; the depth maps cover the photograph and may be smaller.
struct ComposerPhotograph {
  Camera camera;
  PhotographDepth depth;
};

struct ComposerOptions {
  std::size_t candidates = 12;  // K, at least 1
  std::size_t gathered = 4;     // N, at least 1
  int threads = 1;
};

/// Composes views from depth maps. The vote has the view's size.
class Composer {
 public:
  /// Returns a photograph by index, in RGB or RGBA (alpha 0: masked), valid until the next call.
  using PictureSource = std::function<const Image8&(std::size_t)>;

  /// Throws Error{invalidInput} without photographs, for a camera that is not a pinhole, maps of different sizes, or a
  /// step that is not positive.
  explicit Composer(std::vector<ComposerPhotograph> photographs, const ComposerOptions& options = {});

  /// Precondition: a pinhole. Thread-safe if `pictures` is. Memory: 24 K + 130 bytes per pixel, copies of K
  /// photographs, and per thread 100 bytes per pixel of one depth map.
  Composed compose(const Camera& view, const PictureSource& pictures) const;

  /// Photographs that compose() would use for a view, best first, and the weight of each photograph, 0 to 1.
  struct Choice {
    std::size_t photograph = 0;
    double weight = 1;
  };
  std::vector<Choice> candidates(const Camera& view) const;

  /// b: median distance from a photograph to the nearest one at another site; 1 if all are at one site.
  double spacing() const { return spacing_; }

 private:
  std::vector<ComposerPhotograph> photographs_;
  std::vector<ImageF> occluders_;  // ρ at a quarter of a photograph's size, the nearest in each block
  ComposerOptions options_;
  double spacing_ = 1, step_ = 0, medianInverseDepth_ = 0;
};

}  // namespace ibr::reference
