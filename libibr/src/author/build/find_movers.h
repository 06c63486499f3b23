// SPDX-License-Identifier: Apache-2.0
// Movers in the photographs of a build: who judges whom.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "author/build/build_input.h"
#include "author/depth/photograph_depth.h"
#include "author/jobs/build_jobs.h"
#include "author/pixels/bit_mask.h"
#include "ibr/author.h"
#include "ibr/image.h"

namespace ibr {

/// Photographs that judge another one at most.
inline constexpr std::size_t kMostJudges = 3;

/// Those that share the most tracks with each photograph, at most kMostJudges, best first; pinholes only.
std::vector<std::vector<std::uint32_t>> judgesOf(const BuildInput& input);

/// The memory that judging a photograph takes at most, bytes.
double bytesToJudge(const Photograph& photograph);

/// And what is known of all of them at once then, a pixel as it is matched; a photograph of which a quarter differs.
inline constexpr double kJudgementBytesPerPixel = 0.7;

/// Of each photograph what is masked of it, at half the size at which it is matched (settle_movers.h); empty where
/// nothing is, or nobody can judge it. `depths`: of all photographs, in their order. Photographs are stored. Beside
/// what one photograph takes on each thread all of them are held at three bits a pixel of that size, and eight bytes a
/// pixel of what differs, of a quarter of them at most. Throws Error.
std::vector<BitMask> findMovers(const BuildInput& input, std::span<const PhotographDepth> depths,
                                const BuildJobs& jobs);

/// As a mask of this size.
Image8 maskOf(const BitMask& moved, int width, int height);

}  // namespace ibr
