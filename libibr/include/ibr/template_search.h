// SPDX-License-Identifier: Apache-2.0
// Template matching by trying all displacements of a window ([H] Alg. 3): on the processor here, on a device by
// TemplateSearchPass.
#pragma once

#include <cstdint>
#include <functional>
#include <glm/vec2.hpp>
#include <span>
#include <vector>

#include "ibr/image.h"

namespace ibr {

/// How unlike a template and a picture are, over the template's samples.
enum class TemplateMeasure : std::uint8_t {
  absoluteDifferences,  // [H] eq. 1: mean over samples and colours, levels, 0 to 255
  correlation,          // 1 − zero-mean normalised cross-correlation over all three colours, each about its own mean;
                        // 0 to 2, and 1 where either side is flat
};

/// A pixel of the picture, by column and row, and the colour that the template has where that pixel lies when nothing
/// is displaced.
struct TemplateSample {
  std::int16_t x = 0, y = 0;
  std::uint8_t red = 0, green = 0, blue = 0, unused = 0;
};

/// Samples [first, first + count) are looked for in a picture, displaced by start + (−radius … radius)².
struct TemplateTask {
  std::uint32_t picture = 0;
  std::uint32_t first = 0, count = 0;
  glm::ivec2 start{0};  // px
};

struct TemplateMatch {
  glm::ivec2 displacement{0};  // px; of the least cost, the one nearest to the start where several have it, and of
                               // these the first by rows
  float cost = 0;              // as the measure says; infinite where a task has no samples
};

/// Finds the matches of all tasks, in their order. Beyond its border a picture goes on as it ends there.
using TemplateSearch = std::function<std::vector<TemplateMatch>(
    std::span<const TemplateTask> tasks, std::span<const TemplateSample> samples, int radius, TemplateMeasure measure)>;

/// A search over RGB pictures, which are read until it goes.
using MakeTemplateSearch = std::function<TemplateSearch(std::span<const Image8* const> pictures)>;

/// On the processor: each call works on the calling thread and may be made from several at once. Throws
/// Error{invalidInput} for pictures without 3 channels, and in calls for tasks beyond pictures or samples, a radius
/// outside 0 … kLargestTemplateRadius, more than kLargestTemplate samples and starts beyond kFarthestTemplateStart.
TemplateSearch processorTemplateSearch(std::span<const Image8* const> pictures);

inline constexpr int kLargestTemplateRadius = 32;
inline constexpr std::uint32_t kLargestTemplate = 4096;
inline constexpr int kFarthestTemplateStart = 1 << 20;  // px

}  // namespace ibr
