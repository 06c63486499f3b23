// SPDX-License-Identifier: Apache-2.0
#include "author/photographs/border.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace ibr {
namespace {

double areaOf(const std::vector<glm::vec2>& match, glm::uvec3 t) {
  const glm::dvec2 a = match[t.x], b = glm::dvec2(match[t.y]) - a, c = glm::dvec2(match[t.z]) - a;
  return 0.5 * std::abs(b.x * c.y - b.y * c.x);
}

// Samples corners, edges and centre: borders are curved only slightly.
bool whole(const Photograph& photo, const std::vector<glm::vec2>& match, glm::uvec3 t) {
  const std::array<glm::dvec2, 3> corner{match[t.x], match[t.y], match[t.z]};
  const auto seen = [&](glm::dvec2 pixel) { return photographed(pixel, *photo.lens, photo.camera.intrinsics); };
  for (std::size_t i = 0; i < 3; ++i)
    for (const double share : {0.0, 0.25, 0.5, 0.75})
      if (!seen(corner[i] + share * (corner[(i + 1) % 3] - corner[i]))) return false;
  return seen((corner[0] + corner[1] + corner[2]) / 3.0);
}

}  // namespace

BorderCut dropBorder(MorphMesh& mesh, std::span<const Photograph* const> members) {
  if (std::ranges::none_of(members, [](const Photograph* photo) { return photo->lens.has_value(); })) return {};
  double before = 0, left = 0, weighted = 0;
  std::size_t kept = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const glm::uvec3 triangle = mesh.triangles[t];
    const double area = mesh.tier[t] == kTierConsistent ? areaOf(mesh.match[0], triangle) : 0;
    before += area;
    bool inside = true;
    for (std::size_t i = 0; i < members.size() && inside; ++i)
      inside = !members[i]->lens || whole(*members[i], mesh.match[i], triangle);
    if (!inside) continue;
    left += area;
    weighted += area * double(mesh.ecc[t]);
    mesh.triangles[kept] = triangle;
    mesh.tier[kept] = mesh.tier[t];
    mesh.ecc[kept] = mesh.ecc[t];
    ++kept;
  }
  mesh.triangles.resize(kept);
  mesh.tier.resize(kept);
  mesh.ecc.resize(kept);
  BorderCut cut;
  if (before > 0) cut.left = left / before;
  if (left > 0) cut.ecc = weighted / left;
  return cut;
}

}  // namespace ibr
