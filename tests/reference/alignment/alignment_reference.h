// SPDX-License-Identifier: Apache-2.0
// Double-precision reference implementation of the optimiser's evaluation ([T] §3.5–3.6): the pixels a star covers in
// the mean of two meshes, the colours of both photographs there, and their correlation.
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "ibr/image.h"
#include "image/ecc_sums.h"

namespace ibr::reference {

/// Pixels (column, row) whose centre (i + ½, j + ½) the triangle covers by the rasterisation rule: a centre on an edge
/// counts for top and left edges. Corners are in 1/256 px, and the size is below 2²². Empty where (b − a) × (c − a) is
/// not positive.
std::vector<glm::ivec2> coveredPixels(glm::ivec2 a, glm::ivec2 b, glm::ivec2 c);

/// A mesh over several images, as in ibr/optimiser.h.
struct AlignedPictures {
  std::vector<const Image8*> pictures;            // d, RGB
  std::vector<std::vector<glm::ivec2>> position;  // d × n, 1/128 px
  std::vector<glm::uvec3> triangles;
};

/// Sums of one target image; x is the source, y the target. In grey levels, one sum a channel.
struct StarTarget {
  std::size_t member = 0;
  std::int64_t pixels = 0;
  std::array<double, 3> x{}, y{}, xx{}, yy{}, xy{};
};

struct StarEcc {
  std::vector<StarTarget> targets;  // the other members, in order
  Ecc channels;                     // with the variance floor
  Ecc concatenated;                 // [T] eqs 1–3, without the floor
};

/// Evaluates the triangles around `point`, moved by `offset` (1/128 px) from its position in `member`. Both images are
/// sampled at the interpolated corners: bilinear, texel centres at +½, clamped at the border. No image clips pixels of
/// the mean. A mean variance below 1e-9 grey² counts as zero, because rounding alone causes such values.
StarEcc starEcc(const AlignedPictures& mesh, std::uint32_t point, std::size_t member, glm::ivec2 offset = {0, 0},
                double varianceFloor = 0);

}  // namespace ibr::reference
