// SPDX-License-Identifier: Apache-2.0
// Reference composer: a view from photographs with depth, in double precision on the CPU. It is the reference
// implementation of Composition::gathered, and judges depth maps.
//
//   1. candidates  at most K photographs: FramePlan::photographs, or, of depth maps, greedy: Σ over a grid of rays and
//                  two depths of √(Σ border / (.03 + angle))
//   2. layers      every candidate's mesh is drawn into the view at the vote's size: ρ, trust and consensus of the
//                  nearest surface (composer_layer.h)
//   3. vote        hypotheses of a pixel support each other within a tolerance t, weighted by trust and by nearness:
//                      u = trust(c) / (.3 + (d / b)²),   support(ρ) = Σ u (1 − (Δρ / t)²)
//                  a hypothesis is present by its share of the largest support, times max(1 − kernel / .25, 0) for each
//                  of more support; from front to back it shows presence · min(mean(a) / .9, 1) of what those before it
//                  leave, and all as far as nothing is behind. The two that show most are the pixel's surfaces; pixels
//                  without a hypothesis get depth by pull and push (composer_vote.h)
//   4. gather      for each surface the N best candidates by
//                      w = r² · border · visibility / cost,   cost = .03 + angle + .001 d / b
//                  less the (N + 1)-th's w, so that no photograph comes or goes with a step (composer_gather.h). A
//                  surface counts by its opacity and by how well its colours agree
//
// ρ is inverse depth along a camera's axis (of a panorama: along the ray), 1 / world unit; c, v and a: PhotographDepth;
// d: distance of a photograph from the middle of the views; b: spacing of the capture. The image is continuous in the
// camera except where the second and the third surface change places.
//
// Departure: w is divided by s = smoothstep(0, .01, cost − .03), so that a photograph is alone at its own pose.
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
  Image8 picture;  // RGBA; alpha as AlphaContent::tier: kTierAgrees where the depth is confirmed, kTierCompleted where
                   // it was completed, kTierFilled where it was filled in the view, 0 and black where no photograph
                   // shows anything
  ImageF colour;   // RGB of `picture` before rounding, 8-bit levels
  ImageF inverseDepth;        // of the surface that counts most
  ImageF opaqueInverseDepth;  // of the nearest surface that hides at least half of what lies behind: a depth buffer's
  ImageF deviation;           // one standard deviation of opaqueInverseDepth
  ImageF supportMargin;       // Surfaces::margin of the pixel's vote: near 0 where rounding decides which peak wins
};

/// Textures of a scene's photographs, by node, valid until the composition is done.
struct GatherTextures {
  std::function<const std::vector<Image8>&(std::size_t)> photograph;  // RGBA mip levels; alpha is the mask
  std::function<const ImageF&(std::size_t)> depth;                    // as Node::depthFile: red ρ / depthScale
  TextureFilter filter = TextureFilter::trilinear;                    // or bicubic
};

/// A view of a plan with Composition::gathered, from the photographs that the plan has. Throws Error{invalidInput} for
/// RenderSettings::renderScale other than 1, a plan without a spacing, colours or layers out of range, a photograph
/// without evidence in its backdrop's mesh, without texture levels in RGBA, or without a depth texture.
/// Memory: 24 K + 100 bytes a pixel of the vote, 28 bytes a pixel, and 100 bytes a vertex of one mesh for each thread.
Composed composeGathered(const Scene& scene, const FramePlan& plan, std::size_t view, const GatherTextures& textures,
                         int threads = 1);

/// Fills what no photograph shows with colours from around it, of kTierFilled, as a device does where
/// RenderSettings::lowestTier allows. Depth stays as it is.
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

/// Views from depth maps. The vote has the view's size.
class Composer {
 public:
  /// The photograph of a number in RGB or RGBA (alpha 0: not to be shown), valid until the next call.
  using PictureSource = std::function<const Image8&(std::size_t)>;

  /// Throws Error{invalidInput} without photographs, for a camera that is no pinhole, maps of different sizes, or a
  /// step that is not positive.
  explicit Composer(std::vector<ComposerPhotograph> photographs, const ComposerOptions& options = {});

  /// Precondition: a pinhole. Thread-safe where `pictures` is. Memory: 24 K + 130 bytes a pixel, copies of K
  /// photographs, and 100 bytes a pixel of one depth map for each thread.
  Composed compose(const Camera& view, const PictureSource& pictures) const;

  /// Photographs that compose() would use for a view, best first, and the weight that each has as a whole, 0 to 1.
  struct Choice {
    std::size_t photograph = 0;
    double weight = 1;
  };
  std::vector<Choice> candidates(const Camera& view) const;

  /// b: median over the photographs of the distance to the nearest one that was taken elsewhere; 1 where there is none.
  double spacing() const { return spacing_; }

 private:
  std::vector<ComposerPhotograph> photographs_;
  std::vector<ImageF> occluders_;  // ρ at a quarter of a photograph's size, the nearest in each block
  ComposerOptions options_;
  double spacing_ = 1, step_ = 0, medianInverseDepth_ = 0;
};

}  // namespace ibr::reference
