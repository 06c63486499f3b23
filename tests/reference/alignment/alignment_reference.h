// SPDX-License-Identifier: Apache-2.0
// Double-precision twin of the optimiser's evaluation ([T] §3.5–3.6): which pixels a star covers in the mean of two
// meshes, what both photographs show there, and how they correlate.
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

/// Pixels (column, row) whose centre (i + ½, j + ½) the triangle covers, by the rasteriser's rule: of centres on an
/// edge those of a top or a left one. Corners in 1/256 px, below 2²² in size. None where (b − a) × (c − a) is not
/// positive.
std::vector<glm::ivec2> coveredPixels(glm::ivec2 a, glm::ivec2 b, glm::ivec2 c);

/// A mesh over pictures, as in ibr/optimiser.h.
struct AlignedPictures {
  std::vector<const Image8*> pictures;            // d, RGB
  std::vector<std::vector<glm::ivec2>> position;  // d × n, 1/128 px
  std::vector<glm::uvec3> triangles;
};

/// Of one target; x is the source. Grey levels, a sum a channel.
struct StarTarget {
  std::size_t member = 0;
  std::int64_t pixels = 0;
  std::array<double, 3> x{}, y{}, xx{}, yy{}, xy{};
};

struct StarEcc {
  std::vector<StarTarget> targets;  // the other members, in order
  Ecc channels;                     // with the floor
  Ecc concatenated;                 // [T] eqs 1–3, without
};

/// The triangles around `point`, which stands `offset` (1/128 px) from its position in `member`. Both photographs are
/// sampled where the triangle's corners, interpolated, say: bilinear, texel centres at +½, clamped at the border.
/// Pixels of the mean are not clipped by any picture. A mean variance below 1e-9 grey² counts as none: it is rounding.
StarEcc starEcc(const AlignedPictures& mesh, std::uint32_t point, std::size_t member, glm::ivec2 offset = {0, 0},
                double varianceFloor = 0);

}  // namespace ibr::reference
