// SPDX-License-Identifier: Apache-2.0
// Reference composer: a view from photographs with depth, in double precision on the CPU. It judges depth maps, and is
// the reference implementation of the renderer's vote and gather.
//
//   1. candidates  K photographs, greedy: Σ over a grid of rays and two depths of √(Σ border / (.03 + angle))
//   2. vote        every candidate's depth map is drawn into the view as a grid of triangles, cut where depth jumps; at
//                  each pixel the hypotheses support each other within a tolerance t, weighted by trust and by
//                  nearness:
//                      u = trust(c) / (.3 + (d / b)²),   support(ρ) = Σ u (1 − (Δρ / t)²)
//                  peaks from front to back are the pixel's layers, at most two, of opacity mean(a) / .9; pixels
//                  without a hypothesis get depth by push–pull
//   3. gather      for each layer the N best candidates by
//                      w = r² · border · visibility / cost,   cost = .03 + angle + .001 |c_i − p| / b
//                  less the (N + 1)-th's w, so that no photograph comes or goes with a step. A layer counts by its
//                  opacity and by how well its colours agree
//
// ρ is inverse depth along a camera's axis, 1 / world unit; c, v and a: PhotographDepth. The picture is continuous in
// the camera except where a peak appears or the third layer is dropped.
//
// Departure: w is divided by s = smoothstep(0, .01, cost − .03), so that a photograph is alone at its own pose.
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "ibr/camera.h"
#include "ibr/image.h"

namespace ibr::reference {

/// Depth of a photograph, and what other photographs say of it. Four maps of one size.
struct PhotographDepth {
  ImageF inverseDepth;    // along the axis, 1 / world unit, >= 0: known everywhere
  Image8 confirmations;   // c: photographs whose depth is the same there; 0 where depth was completed
  ImageF consensus;       // a: (c + .25) / (c + v + .5), v photographs that see past it; .1 where completed
  double step = 0;        // ρ that moves a point by 1 px at half the photograph's size over the spacing b, > 0
  double residualPx = 0;  // median reprojection residual, px of the photograph
};

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

/// A composed view.
struct Composed {
  Image8 picture;  // RGBA; alpha as AlphaContent::tier: kTierAgrees where the depth is confirmed, kTierBackdrop where
                   // it was completed, kTierFilled where it was filled in the view, 0 and black where no photograph
                   // shows anything
  ImageF inverseDepth;  // of the layer that counts most, along the view's axis
};

class Composer {
 public:
  /// The photograph of a number in RGB or RGBA (alpha 0: not to be shown), valid until the next call.
  using PictureSource = std::function<const Image8&(std::size_t)>;

  /// Throws Error{invalidInput} without photographs, for a camera that is no pinhole, maps of different sizes, or a
  /// step that is not positive.
  explicit Composer(std::vector<ComposerPhotograph> photographs, const ComposerOptions& options = {});

  /// Precondition: a pinhole. Thread-safe where `pictures` is. Memory: 16 K + 80 bytes a pixel, and copies of K
  /// photographs.
  Composed compose(const Camera& view, const PictureSource& pictures) const;

  /// Photographs that compose() would use for a view, best first, and the weight that each has as a whole, 0 to 1.
  struct Candidate {
    std::size_t photograph = 0;
    double weight = 1;
  };
  std::vector<Candidate> candidates(const Camera& view) const;

  /// b: median over the photographs of the distance to the nearest one that was taken elsewhere; 1 where there is none.
  double spacing() const { return spacing_; }

 private:
  std::vector<ComposerPhotograph> photographs_;
  std::vector<ImageF> occluders_;  // ρ at a quarter of a photograph's size, the nearest in each block
  ComposerOptions options_;
  double spacing_ = 1, step_ = 0, medianInverseDepth_ = 0;
};

}  // namespace ibr::reference
