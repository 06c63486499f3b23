// SPDX-License-Identifier: Apache-2.0
// Finds moving objects in the photographs of a build, by comparing each with others.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "author/build/build_input.h"
#include "author/depth/photograph_depth.h"
#include "author/jobs/build_jobs.h"
#include "author/pixels/bit_mask.h"
#include "ibr/author/poses.h"
#include "ibr/image.h"

namespace ibr {

/// Max number of photographs that one is compared with.
inline constexpr std::size_t kMaxComparisons = 3;

/// For each photograph those that share the most tracks, at most kMaxComparisons, best first; pinholes only.
std::vector<std::vector<std::uint32_t>> comparisonPhotographs(const BuildInput& input);

/// Peak memory of comparing one photograph, bytes.
double bytesToCompare(const Photograph& photograph);

/// Memory held of all comparisons at once, bytes per matched pixel, if a quarter of a photograph differs.
inline constexpr double kComparisonBytesPerPixel = 0.7;

/// Masks of moving objects, at half the matched size (settle_movers.h). A mask is empty if nothing moved or the
/// photograph cannot be compared. `depths`: of all photographs, in their order. The photographs must be stored. Holds
/// three bits per mask pixel of all photographs, and eight bytes per differing pixel, for a quarter of them at most.
/// Throws Error.
std::vector<BitMask> findMovers(const BuildInput& input, std::span<const PhotographDepth> depths,
                                const BuildJobs& jobs);

/// Converts a bit mask to a mask image of this size: 0 where something moved, else 255.
Image8 maskOf(const BitMask& moved, int width, int height);

}  // namespace ibr
