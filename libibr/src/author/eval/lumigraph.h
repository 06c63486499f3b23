// SPDX-License-Identifier: Apache-2.0
// Unstructured lumigraph rendering (Buehler, Bosse, McMillan, Gortler, Cohen 2001) with a depth map a photograph for
// its geometric proxy.
//
//   proxy   the photographs' depth maps as grids of triangles, cut where they are stretched, brought into the view; a
//           pixel gets the nearest surface that two of them agree on, else the median; holes take the nearest pixel's
//   pixel   penalty of a photograph: angle between the view's ray and its own + β · how much coarser it sees the point;
//           the k best are blended with weights (1 − p / p_k+1) / p, so that no photograph comes or goes with a step
//           and one from the view's own place is alone. Towards a picture's border its penalty grows to infinity
//   hidden  a photograph whose own depth stands before the point, by more than a few pixels of parallax from the view,
//           comes after all that see it
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "author/depth/depth_map.h"
#include "ibr/camera.h"
#include "ibr/image.h"

namespace ibr {

/// Inverse depth along the axis of `view`, of its size, in the picture of another depth map; kUnknownDepth where it
/// shows nothing.
ImageF warpedDepth(const Camera& view, const DepthMap& map);

/// What the view sees: never unknown unless all maps are, then infinitely far everywhere.
ImageF proxyDepth(const Camera& view, std::span<const DepthMap* const> maps, int threads);

struct LumigraphOptions {
  int best = 4;                   // photographs a pixel
  double resolutionWeight = 0.2;  // β, radians a factor of 2 that the photograph is coarser
  int threads = 1;
};

/// A view's picture, photograph after photograph: no more than one need be in memory. Their order matters only where
/// two are equally good. 8 (best + 1) bytes a pixel.
class LumigraphPicture {
 public:
  /// `proxy` is of the view's shape, and may be smaller.
  LumigraphPicture(const Camera& view, ImageF proxy, const LumigraphOptions& options = {});

  /// `depth` is the photograph's own.
  void add(const Camera& photograph, const Image8& picture, const DepthMap& depth);

  /// RGBA, alpha 0 and black where no photograph shows anything.
  Image8 picture() const;

 private:
  struct Candidate {
    float penalty;
    std::uint8_t colour[3];
  };
  void addRow(int y, const Camera& photograph, const Image8& picture, const DepthMap& depth);

  Camera view_;
  ImageF proxy_;
  LumigraphOptions options_;
  std::vector<Candidate> candidates_;  // best + 1 a pixel, best first, penalty infinite where there are no more
};

}  // namespace ibr
