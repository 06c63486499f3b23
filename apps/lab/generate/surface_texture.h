// SPDX-License-Identifier: Apache-2.0
// Textures of walls, floors and things, with detail at all scales, as linear light with mip levels.
#pragma once

#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <vector>

namespace ibr {

enum class Material : std::uint8_t { brick, stone, tiles, planks, crate, poster, cloth };

/// A rectangle of one material, visible from both sides. Lengths in metres.
struct Surface {
  glm::dvec3 origin{0.0};           // the rectangle's centre, world
  glm::dvec3 u{1.0, 0.0, 0.0};      // unit, along its width
  glm::dvec3 v{0.0, 1.0, 0.0};      // unit, perpendicular to u
  double extentU = 1, extentV = 1;  // width and height
  Material material = Material::brick;
  std::uint32_t seed = 1;
};

/// Returns linear RGB, 0 to 1, of a lit surface at a point from the rectangle's centre. `texel`: length of the finest
/// detail.
glm::vec3 surfaceColour(const Surface& surface, glm::dvec2 at, double texel);

/// Mip levels of a surface. Texels hold the square root of linear light in 8 bits.
class SurfaceTexture {
 public:
  /// `density`: texels per metre of the finest level.
  SurfaceTexture(const Surface& surface, double density);

  /// Returns linear RGB at shares of width and height, interpolated within and between levels. `level` may be a
  /// fraction.
  glm::vec3 sample(glm::vec2 share, float level) const;

 private:
  struct Level {
    int width, height;
    std::vector<std::uint32_t> texels;
    glm::vec3 sample(glm::vec2 share) const;
  };
  std::vector<Level> levels_;
};

}  // namespace ibr
