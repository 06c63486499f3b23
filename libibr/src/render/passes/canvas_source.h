// SPDX-License-Identifier: Apache-2.0
// Source images of the passes after the cells: the canvas, or one layer of the canvas of both eyes.
#pragma once

#include <vector>

#include "gpu/draw/canvas.h"

namespace ibr {

inline constexpr std::size_t kFromCanvas = 0, kFromEyes = 1;  // kFromEyes + layer

struct CanvasSource {
  VkImageView colour, depth;
};

/// `eyes`: the canvas of both eyes; may be null.
inline std::vector<CanvasSource> sourcesOf(const Canvas& canvas, const Canvas* eyes) {
  std::vector<CanvasSource> sources{{canvas.colourView(), canvas.depthView()}};
  for (std::uint32_t layer = 0; eyes && layer < 2; ++layer)
    sources.push_back({eyes->colourView(layer), eyes->depthView(layer)});
  return sources;
}

}  // namespace ibr
