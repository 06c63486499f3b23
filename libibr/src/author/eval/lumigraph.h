// SPDX-License-Identifier: Apache-2.0
// Unstructured lumigraph rendering (Buehler, Bosse, McMillan, Gortler, Cohen 2001), with the photographs' depth maps as
// geometric proxy.
//
//   proxy   the depth maps as triangle grids, cut where stretched, projected into the view; a pixel gets the nearest
//           surface that two maps agree on, else the median; holes take the value of the nearest pixel
//   pixel   penalty of a photograph: angle between its ray and the view's + β · its coarseness at the point. The k best
//           are blended with weights (1 − p / p_k+1) / p, so that photographs fade in and out, and a photograph at the
//           view's position is shown alone. The penalty grows to infinity towards the photograph's border
//   hidden  a photograph whose own depth occludes the point by more than a few pixels of parallax ranks behind all that
//           see the point
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "author/depth/depth_map.h"
#include "ibr/camera.h"
#include "ibr/image.h"

namespace ibr {

/// Inverse depth of `map` as seen from `view`: along the axis and at the size of `view`; kUnknownDepth where the map
/// shows nothing.
ImageF warpedDepth(const Camera& view, const DepthMap& map);

/// Fused inverse depth of the view, known everywhere. If all maps are unknown, 0 (infinity) everywhere.
ImageF proxyDepth(const Camera& view, std::span<const DepthMap* const> maps, int threads);

struct LumigraphOptions {
  int best = 4;                   // photographs per pixel
  double resolutionWeight = 0.2;  // β, radians per factor of 2 by which the photograph is coarser
  int threads = 1;
};

/// Renders a view from photographs that are added one by one, so only one need be in memory. Their order matters only
/// for ties. Takes 8 (best + 1) bytes per pixel.
class LumigraphImage {
 public:
  /// `proxy`: of the view's aspect, may be smaller.
  LumigraphImage(const Camera& view, ImageF proxy, const LumigraphOptions& options = {});

  /// `depth`: the photograph's own.
  void add(const Camera& photograph, const Image8& picture, const DepthMap& depth);

  /// RGBA; alpha 0 and black where no photograph shows anything.
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
  std::vector<Candidate> candidates_;  // best + 1 per pixel, best first; penalty infinite in free slots
};

}  // namespace ibr
