// SPDX-License-Identifier: Apache-2.0
// Double-precision twin of the cell pass and the composition: what a frame plan should look like, pixel by pixel.
#pragma once

#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "ibr/renderer.h"

namespace ibr::reference {

/// What BufferTargets holds of a pixel.
struct Known {
  double depth = std::numeric_limits<double>::infinity();
  int tier = -1, rank = -1;
  double extrapolation = 0;
  std::array<double, 4> weights{};
  double spread = 0, uncertainty = std::numeric_limits<double>::infinity();
  double inverseDistance = 0;      // ρ
  std::array<double, 4> shares{};  // of the members in the colour, dithering included
  double agreement = 2;            // of Overlay::agreement, where the plan asks for it: see agreementOf
};

struct Picture {
  int width = 0, height = 0;
  std::vector<glm::dvec4> colour;  // RGB display-encoded, 0 to 1, and the canvas's tier code; (0, 0, 0, 0) in holes
  std::vector<std::uint8_t> safe;  // 1 where the pixel and its eight neighbours show one cell
  std::vector<double> edge;        // px to the nearest edge of a triangle: see isCertain
  std::vector<double> range;       // levels by which the texels differ that the colour was made of
  std::vector<double> levelRange;  // levels by which the two mip levels differ
  std::vector<Known> known;        // of the plan's current order
  std::vector<int> overlap;        // cells that show the pixel, hidden ones too
};

/// Whether every device must draw the pixel as the twin does, but for its texture filter. Vertices are snapped to
/// 2^-subPixelBits px (VkPhysicalDeviceLimits::subPixelPrecisionBits), half a step in x and in y, so edges move by up
/// to 2^-subPixelBits / sqrt(2) px; a pixel that changes from one triangle of a cell to the next has the other's mip
/// level.
inline bool isCertain(const Picture& picture, std::size_t pixel, unsigned subPixelBits) {
  return picture.safe[pixel] && picture.edge[pixel] > std::exp2(-double(subPixelBits));
}

/// What the target of a view receives, its alpha being the tier code. `textures`: a mip chain a node, as TextureSource
/// gives it; `filter`: trilinear or bicubic. While a switch is mixed, `safe` and `range` hold for both pictures.
Picture render(const Scene& scene, const std::vector<std::vector<Image8>>& textures, const FramePlan& plan,
               std::size_t view = 0, TextureFilter filter = TextureFilter::trilinear);

}  // namespace ibr::reference
