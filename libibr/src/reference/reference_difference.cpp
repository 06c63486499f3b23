// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "ibr/author/reference.h"
#include "reference/cell_pass_reference.h"
#include "render/plan/colour_table.h"

namespace ibr {

ReferenceDifference differenceFromReference(const Scene& scene, const std::vector<std::vector<Image8>>& textures,
                                            const FramePlan& plan, const Image8& picture,
                                            const DevicePrecision& precision) {
  const reference::RenderedImage exact = reference::render(scene, textures, plan);
  const double step = std::exp2(-double(precision.subTexelBits)), levelStep = std::exp2(-double(precision.mipmapBits));
  ReferenceDifference error;
  double sum = 0, values = 0, beyond = 0;
  for (int y = 0; y < exact.height; ++y)
    for (int x = 0; x < exact.width; ++x) {
      const std::size_t at = std::size_t(y) * std::size_t(exact.width) + std::size_t(x);
      if (!reference::isCertain(exact, at, precision.subPixelBits)) continue;
      const double bound = 1 + std::ceil(2 * step * exact.range[at] + levelStep * exact.levelRange[at]);
      for (int c = 0; c < 3; ++c) {
        const double off = std::abs(picture.pixel(x, y)[std::size_t(c)] - exact.colour[at][c] * 255);
        sum += off;
        ++values;
        beyond += off > bound;
        error.largestLevels = std::max(error.largestLevels, off);
      }
    }
  error.compared = values / (3.0 * exact.width * exact.height);
  error.meanLevels = sum / values;
  error.beyondBound = values > 0 ? beyond / values : 0;
  return error;
}

std::array<std::uint8_t, 256> colourTable(const std::array<std::uint32_t, 256>& from,
                                          const std::array<std::uint32_t, 256>& to) {
  return levelTable(to, from, shader::kMapPreserving, 1);
}

}  // namespace ibr
