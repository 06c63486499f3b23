// SPDX-License-Identifier: Apache-2.0
// Template matching by exhaustive search in a window ([H] Alg. 3): on the CPU here, on a device by TemplateSearchPass.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "ibr/conventions.h"
#include "ibr/export.h"
#include "ibr/image.h"

namespace ibr {

/// Dissimilarity of a template and a picture, over the template's samples.
enum class TemplateMeasure : std::uint8_t {
  absoluteDifferences,  // [H] eq. 1: mean over samples and colours, 8-bit levels, 0 to 255
  correlation,          // 1 − zero-mean normalised cross-correlation over all three colours, each with its own mean;
                        // 0 to 2; 1 where template or picture has no contrast
};

/// A pixel of a template: its column and row in the picture at displacement 0, and its colour.
struct TemplateSample {
  std::int16_t x = 0, y = 0;  // x: column, px; y: row, px
  // red: 8-bit level; green: 8-bit level; blue: 8-bit level; padding: not used, fills up to 8 bytes
  std::uint8_t red = 0, green = 0, blue = 0, padding = 0;
};

/// Searches a picture for samples [first, first + count), at displacements start + (−radius … radius)².
struct TemplateTask {
  std::uint32_t picture = 0;           // index of the picture
  std::uint32_t first = 0, count = 0;  // first: index of the first sample; count: number of samples
  glm::ivec2 start{0};                 // centre of the searched displacements, px
};

/// The best match of a task.
struct TemplateMatch {
  glm::ivec2 displacement{0};  // px, of minimum cost. Ties: the one nearest to the start, then the first in row order
  float cost = 0;              // dissimilarity by TemplateMeasure; infinite where the task has no samples
};

/// Finds the matches of all tasks, in their order. Pixels beyond a picture's border have the nearest border pixel's
/// colour.
using TemplateSearch = std::function<std::vector<TemplateMatch>(
    std::span<const TemplateTask> tasks, std::span<const TemplateSample> samples, int radius, TemplateMeasure measure)>;

/// Makes a search over RGB pictures, which must outlive the search.
using TemplateSearchFactory = std::function<TemplateSearch(std::span<const Image8* const> pictures)>;

/// Makes a search on the CPU. The search runs on the calling thread; several threads may call it at once. Throws
/// Error{invalidInput} for pictures without 3 channels. Calls of the search throw it for indices of pictures or samples
/// out of range, and for a radius outside 0 … kMaxTemplateRadius. They also throw it for more than
/// kMaxTemplateSampleCount samples in a task and for starts beyond kMaxTemplateStartPx.
IBR_API TemplateSearch cpuTemplateSearch(std::span<const Image8* const> pictures);

inline constexpr int kMaxTemplateRadius = 32;                   // maximum radius of a search, px
inline constexpr std::uint32_t kMaxTemplateSampleCount = 4096;  // maximum number of samples of a task
inline constexpr int kMaxTemplateStartPx = 1 << 20;             // maximum of |start.x| and |start.y|, px

}  // namespace ibr
