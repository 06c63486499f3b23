// SPDX-License-Identifier: Apache-2.0
// Reference implementation, in double precision, of the cell pass and the composition of a frame plan.
#pragma once

#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "ibr/renderer.h"

namespace ibr::reference {

/// Values of BufferTargets for a pixel.
struct BufferValues {
  double depth = std::numeric_limits<double>::infinity();
  int tier = -1, rank = -1;
  double extrapolation = 0;
  std::array<double, 4> weights{};
  double spread = 0, uncertainty = std::numeric_limits<double>::infinity();
  double inverseDistance = 0;      // ρ
  std::array<double, 4> shares{};  // of the members in the colour, dithering included
  double agreement = 2;            // for Overlay::agreement: mean correlation of the members; 2: none
};

struct RenderedImage {
  int width = 0, height = 0;
  std::vector<glm::dvec4> colour;   // RGB display-encoded, 0 to 1, and the canvas's tier code; (0, 0, 0, 0) in holes
  std::vector<std::uint8_t> safe;   // 1 where the pixel and its eight neighbours show one cell
  std::vector<double> edge;         // px to the nearest edge of a triangle: see isCertain
  std::vector<double> range;        // range, in 8-bit levels, of the texels behind the colour
  std::vector<double> levelRange;   // difference of the two mip levels, 8-bit levels
  std::vector<BufferValues> known;  // of the plan's current order
  std::vector<int> overlap;         // number of cells that cover the pixel, hidden ones included
};

/// True if every device must draw the pixel like this implementation, texture filters aside. Devices snap vertices to
/// 2^-subPixelBits px (VkPhysicalDeviceLimits::subPixelPrecisionBits), by up to half a step in x and in y. So edges
/// move by up to 2^-subPixelBits / sqrt(2) px. A pixel that changes to a neighbouring triangle of its cell takes that
/// triangle's mip level.
inline bool isCertain(const RenderedImage& picture, std::size_t pixel, unsigned subPixelBits) {
  return picture.safe[pixel] && picture.edge[pixel] > std::exp2(-double(subPixelBits));
}

/// Renders the target of a view; alpha is the tier code. `textures`: one mip chain per node, as from TextureSource;
/// `filter`: trilinear or bicubic. During a cross-fade of draw orders, `safe` and `range` hold for both images.
RenderedImage render(const Scene& scene, const std::vector<std::vector<Image8>>& textures, const FramePlan& plan,
                     std::size_t view = 0, TextureFilter filter = TextureFilter::trilinear);

}  // namespace ibr::reference
