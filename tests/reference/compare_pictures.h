// SPDX-License-Identifier: Apache-2.0
// Compares images of the GPU with the double-precision reference implementation.
#pragma once

#include <catch2/catch.hpp>
#include <cmath>
#include <cstdlib>

#include "reference/cell_pass_reference.h"
#include "reference/stage.h"
#include "support/gpu.h"

namespace ibr::test {

/// The tolerance follows from the device's texture filter. `leastDrawn`: minimum share of compared pixels that are
/// drawn. `leastSafe`: minimum share of the image's pixels that are compared.
inline void compareWithTwin(const Stage& stage, const FramePlan& plan, double leastDrawn = 0.25, double leastSafe = 0.5,
                            std::size_t view = 0) {
  const Image8 picture = plan.views.size() == 1 ? stage.render(plan) : stage.renderViews(plan)[view];
  const reference::Picture twin = reference::render(stage.scene(), stage.textures(), plan, view, stage.filter());
  VkPhysicalDeviceProperties properties;
  vkGetPhysicalDeviceProperties(testDevice().physicalDevice(), &properties);
  const double step = std::exp2(-double(properties.limits.subTexelPrecisionBits));
  const double levelStep = std::exp2(-double(properties.limits.mipmapPrecisionBits));
  std::size_t compared = 0, wrongColour = 0, wrongTier = 0, drawn = 0;
  for (int y = 0; y < twin.height; ++y)
    for (int x = 0; x < twin.width; ++x) {
      const std::size_t at = std::size_t(y) * std::size_t(twin.width) + std::size_t(x);
      if (!reference::isCertain(twin, at, properties.limits.subPixelPrecisionBits)) continue;
      ++compared;
      const auto pixel = picture.pixel(x, y);
      drawn += pixel[3] != 0;
      wrongTier += pixel[3] != std::lround(twin.colour[at].a * 255);
      const double tolerance = 1 + std::ceil(2 * step * twin.range[at] + levelStep * twin.levelRange[at]);
      for (int c = 0; c < 3; ++c) wrongColour += std::abs(pixel[c] - twin.colour[at][c] * 255) > tolerance;
    }
  CHECK(double(compared) > leastSafe * twin.width * twin.height);
  CHECK(double(drawn) >= leastDrawn * double(compared));
  CHECK(wrongColour == 0);
  CHECK(wrongTier == 0);
}

}  // namespace ibr::test
