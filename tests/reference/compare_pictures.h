// SPDX-License-Identifier: Apache-2.0
// Compares images of the GPU with the double-precision reference implementation.
#pragma once

#include <catch2/catch.hpp>
#include <cmath>
#include <cstdlib>

#include "base/vulkan/functions.h"
#include "reference/cell_pass_reference.h"
#include "reference/stage.h"
#include "support/gpu.h"

namespace ibr::test {

/// The tolerance follows from the device's texture filter. `minDrawn`: minimum share of compared pixels that are
/// drawn. `minSafe`: minimum share of the image's pixels that are compared.
inline void compareWithReference(const Stage& stage, const FramePlan& plan, double minDrawn = 0.25,
                                 double minSafe = 0.5, std::size_t view = 0) {
  const Image8 picture = plan.views.size() == 1 ? stage.render(plan) : stage.renderViews(plan)[view];
  const reference::RenderedImage ref = reference::render(stage.scene(), stage.textures(), plan, view, stage.filter());
  VkPhysicalDeviceProperties properties;
  vkGetPhysicalDeviceProperties(testDevice().physicalDevice(), &properties);
  const double step = std::exp2(-double(properties.limits.subTexelPrecisionBits));
  const double levelStep = std::exp2(-double(properties.limits.mipmapPrecisionBits));
  std::size_t compared = 0, wrongColour = 0, wrongTier = 0, drawn = 0;
  for (int y = 0; y < ref.height; ++y)
    for (int x = 0; x < ref.width; ++x) {
      const std::size_t at = std::size_t(y) * std::size_t(ref.width) + std::size_t(x);
      if (!reference::isCertain(ref, at, properties.limits.subPixelPrecisionBits)) continue;
      ++compared;
      const auto pixel = picture.pixel(x, y);
      drawn += pixel[3] != 0;
      wrongTier += pixel[3] != std::lround(ref.colour[at].a * 255);
      const double tolerance = 1 + std::ceil(2 * step * ref.range[at] + levelStep * ref.levelRange[at]);
      for (int c = 0; c < 3; ++c) wrongColour += std::abs(pixel[c] - ref.colour[at][c] * 255) > tolerance;
    }
  CHECK(double(compared) > minSafe * ref.width * ref.height);
  CHECK(double(drawn) >= minDrawn * double(compared));
  CHECK(wrongColour == 0);
  CHECK(wrongTier == 0);
}

}  // namespace ibr::test
