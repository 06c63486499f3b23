// SPDX-License-Identifier: Apache-2.0
#include "author/sweep/visibility.h"

#include <algorithm>
#include <vector>

namespace ibr {

Image8 visibleFrom(const FrameToMember& map, const ImageF& inverseDepth, const Image8& solid, int memberWidth,
                   int memberHeight, float tolerance) {
  const int width = inverseDepth.width, height = inverseDepth.height;
  // Inverse depth along the member's axis: 1 / (depth · h.z), with the frame's depth 1 / w and h at that depth.
  struct Seen {
    int x, y;  // -1: outside
    float inverse;
  };
  std::vector<Seen> seen(inverseDepth.values.size());
  ImageF nearest(memberWidth, memberHeight, 1);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const std::size_t at = std::size_t(y) * std::size_t(width) + std::size_t(x);
      const double w = inverseDepth.values[at];
      const glm::dvec3 h = map.homogeneous({x + 0.5, y + 0.5}, w);
      Seen& s = seen[at];
      s.x = -1;
      if (!(h.z > 0)) continue;
      const double px = h.x / h.z, py = h.y / h.z;
      if (!(px >= 0 && py >= 0 && px < memberWidth && py < memberHeight)) continue;
      s = {int(px), int(py), float(w / h.z)};
      if (!solid.values[at]) continue;
      for (int v = std::max(s.y - 1, 0); v <= std::min(s.y + 1, memberHeight - 1); ++v)
        for (int u = std::max(s.x - 1, 0); u <= std::min(s.x + 1, memberWidth - 1); ++u) {
          float& there = nearest.values[std::size_t(v) * std::size_t(memberWidth) + std::size_t(u)];
          there = std::max(there, s.inverse);
        }
    }
  Image8 visible(width, height, 1);
  for (std::size_t at = 0; at < seen.size(); ++at) {
    const Seen& s = seen[at];
    if (s.x < 0) continue;
    const float front = nearest.values[std::size_t(s.y) * std::size_t(memberWidth) + std::size_t(s.x)];
    visible.values[at] = front <= s.inverse + tolerance;
  }
  return visible;
}

}  // namespace ibr
