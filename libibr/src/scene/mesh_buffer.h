// SPDX-License-Identifier: Apache-2.0
// Stores a morphing mesh as the bytes of one buffer file of a scene.
//
// Consecutive arrays, little-endian, each aligned to 4 bytes:
//   TEXCOORD_i    member by member: 2 floats per point, match / image size
//   _RATIO        d floats per point
//   _INVERSE_DISTANCE, _UNCERTAINTY   one float per point
//   POSITION      3 floats per point, relative to the members' mean position; for display
//   ecc           one float per triangle
//   indices       3 per triangle, tier 0 first; 16 bits up to 65,535 points, else 32
//   _PLANES       4 of 16 bits per point, if the mesh has planes
//   _CONFIRMATIONS  one byte per point and three of padding, since glTF aligns vertex attributes; if the mesh has
//                   evidence
//   _CONSENSUS    one float per point, if the mesh has evidence
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "ibr/scene.h"

namespace ibr {

/// Numbers that determine all offsets.
struct MeshLayout {
  std::size_t members = 0, points = 0, tier0 = 0, tier1 = 0;
  bool hasPlanes = false, hasEvidence = false;

  static constexpr std::size_t kConfirmationsStride = 4;  // bytes
  struct Array {
    std::size_t offset = 0, bytes = 0;
  };
  bool wideIndices() const { return points > 65535; }
  std::size_t indexBytes() const { return wideIndices() ? 4 : 2; }
  Array textureCoordinates(std::size_t member) const { return {member * points * 8, points * 8}; }
  Array ratio() const { return {members * points * 8, members * points * 4}; }
  Array inverseDistance() const { return {members * points * 12, points * 4}; }
  Array uncertainty() const { return {members * points * 12 + points * 4, points * 4}; }
  Array position() const { return {members * points * 12 + points * 8, points * 12}; }
  Array ecc(int tier) const {
    return {members * points * 12 + points * 20 + (tier == 0 ? 0 : tier0 * 4), (tier == 0 ? tier0 : tier1) * 4};
  }
  Array indices(int tier) const {
    const std::size_t start = members * points * 12 + points * 20 + (tier0 + tier1) * 4;
    const std::size_t first = (tier0 * 3 * indexBytes() + 3) & ~std::size_t(3);
    return {start + (tier == 0 ? 0 : first), (tier == 0 ? tier0 : tier1) * 3 * indexBytes()};
  }
  Array planes() const {
    return {(indices(1).offset + indices(1).bytes + 3) & ~std::size_t(3), hasPlanes ? points * 8 : 0};
  }
  Array confirmations() const {
    return {planes().offset + planes().bytes, hasEvidence ? points * kConfirmationsStride : 0};
  }
  Array consensus() const { return {confirmations().offset + confirmations().bytes, hasEvidence ? points * 4 : 0}; }
  std::size_t bytes() const { return consensus().offset + consensus().bytes; }
};

MeshLayout layoutOf(const MorphMesh& mesh);

/// Grid of stored matches: 2⁻⁹ px, or 2⁻⁷ px for images with a side over 16384 px. A match on the grid survives the
/// conversion to float texture coordinates and back exactly.
float quantisedMatch(float pixel, int side);
float textureCoordinate(float pixel, int side);
float matchFromTexture(float coordinate, int side);

/// True if the planes of a point ascend and end in zeros.
inline bool isPlaneSet(const glm::u16vec4& set) {
  for (int k = 1; k < 4; ++k)
    if (set[k] != 0 && set[k] <= set[k - 1]) return false;
  for (int k = 1; k < 4; ++k)
    if (set[k] != 0 && set[k - 1] == 0) return false;
  return true;
}

/// Positions of a cell's vertices in viewers without support for the extension, relative to `displayOrigin`. A point at
/// infinity is at 1000 times the cell's longest edge (at 1000 if that edge is 0).
glm::dvec3 displayOrigin(const Scene& scene, const Cell& cell);
std::vector<glm::vec3> displayPositions(const Scene& scene, const Cell& cell);

/// Encodes a cell's mesh, with matches rounded to the grid. Precondition: validate(scene) is empty.
std::vector<std::byte> encodeMesh(const Scene& scene, const Cell& cell);

/// The inverse of encodeMesh; `sizes`: width and height of the members' images. Checks indices, but not values. Throws
/// Error{invalidInput} if the number of bytes does not match the layout.
MorphMesh decodeMesh(std::span<const std::byte> bytes, const MeshLayout& layout, std::span<const glm::ivec2> sizes);

}  // namespace ibr
