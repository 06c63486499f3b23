// SPDX-License-Identifier: Apache-2.0
// Renders surfaces on the processor, one sample a pixel, in linear light. An image is the mean of several calls with
// offsets of samples within the pixel, or with poses during an exposure.
#pragma once

#include <functional>
#include <vector>

#include "ibr/camera.h"
#include "ibr/image.h"
#include "lab/generate/surface_texture.h"

namespace ibr {

class SurfaceRenderer {
 public:
  /// Generates the textures on `threads` threads. `density`: texels per metre. `report` gets the number of finished
  /// surfaces. Throws ErrorCode::cancelled when report returns false.
  SurfaceRenderer(
      std::vector<Surface> surfaces, double density, int threads,
      const std::function<bool(std::size_t done)>& report = [](std::size_t) { return true; });

  /// Adds linear RGB of a pinhole's samples, at `offset` (px) from the upper left corner of each pixel, to `sum`. Adds
  /// nothing where no surface is seen.
  void addSamples(const Camera& camera, glm::dvec2 offset, ImageF& sum) const;

  /// Returns exact inverse distances along the viewing axis at a pinhole's pixel centres, 0 where no surface is seen.
  ImageF inverseDepth(const Camera& camera) const;

 private:
  struct Projected;
  struct Visible;
  Visible visible(const Camera& camera, glm::dvec2 offset) const;

  std::vector<Surface> surfaces_;
  std::vector<SurfaceTexture> textures_;
  double density_;
};

/// Returns the offset of sample `i` within a pixel, 0 to 1: any first n samples are spread evenly.
glm::dvec2 sampleOffset(std::size_t i);

/// Encodes `sum` / `samples`, linear light of 0 to 1, as sRGB.
Image8 encodedMean(const ImageF& sum, std::size_t samples);

}  // namespace ibr
