// SPDX-License-Identifier: Apache-2.0
#include "author/match/plane_labels.h"

#include <algorithm>
#include <limits>

namespace ibr {
namespace {

bool contains(const glm::u16vec4& set, std::uint16_t plane) {
  return set.x == plane || set.y == plane || set.z == plane || set.w == plane;
}

}  // namespace

std::uint16_t commonPlane(const glm::u16vec4& a, const glm::u16vec4& b, const glm::u16vec4& c) {
  for (int k = 0; k < 4; ++k)
    if (a[k] != 0 && contains(b, a[k]) && contains(c, a[k])) return a[k];
  return 0;
}

double homogeneousShare(const MorphMesh& mesh) {
  const std::size_t tier0 = mesh.tier0Count();
  if (mesh.planes.empty() || tier0 == 0) return std::numeric_limits<double>::quiet_NaN();
  const auto count = std::count_if(mesh.triangles.begin(), mesh.triangles.begin() + std::ptrdiff_t(tier0),
                                   [&](const glm::uvec3& t) { return homogeneous(mesh.planes, t); });
  return double(count) / double(tier0);
}

}  // namespace ibr
