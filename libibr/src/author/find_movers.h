// SPDX-License-Identifier: Apache-2.0
// Movers in the photographs of a build: who judges whom.
#pragma once

#include <cstdint>
#include <vector>

#include "author/build_input.h"
#include "author/build_jobs.h"
#include "ibr/author.h"
#include "ibr/image.h"

namespace ibr {

/// Photographs that judge another one at most.
inline constexpr std::size_t kMostJudges = 3;

/// Those that share the most tracks with each photograph, at most kMostJudges, best first; pinholes only.
std::vector<std::vector<std::uint32_t>> judgesOf(const BuildInput& input);

/// Of each photograph a mask of its stored size, 0 where something moved; empty where nothing was found, or nobody
/// can judge it. Photographs are stored. Throws Error.
std::vector<Image8> findMovers(const BuildInput& input, const BuildJobs& jobs);

}  // namespace ibr
