// SPDX-License-Identifier: Apache-2.0
#include "author/plane_labels.h"

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

}  // namespace ibr
