// SPDX-License-Identifier: Apache-2.0
// Where the passes after the cells find what was drawn: in the canvas, or in a layer of the one for both eyes.
#pragma once

#include <vector>

#include "gpu/draw/canvas.h"

namespace ibr {

inline constexpr std::size_t kFromCanvas = 0, kFromEyes = 1;  // plus the layer

struct CanvasSource {
  VkImageView colour, depth;
};

/// `eyes` may be null.
inline std::vector<CanvasSource> sourcesOf(const Canvas& canvas, const Canvas* eyes) {
  std::vector<CanvasSource> sources{{canvas.colourView(), canvas.depthView()}};
  for (std::uint32_t layer = 0; eyes && layer < 2; ++layer)
    sources.push_back({eyes->colourView(layer), eyes->depthView(layer)});
  return sources;
}

}  // namespace ibr
