// SPDX-License-Identifier: Apache-2.0
// Depth of all photographs of a build.
#pragma once

#include <vector>

#include "author/build/build_input.h"
#include "author/depth/photograph_depth.h"
#include "author/jobs/build_jobs.h"
#include "ibr/author/build.h"

namespace ibr {

/// Reprojection error of the model's points, px of the stored photographs.
double storedResidualPx(const BuildInput& input);

/// Depth of the photographs' views, and what is known of photographs without it.
struct MatchedViews {
  DepthMatches matches;     // thread-safe
  PhotographPoints points;  // of a photograph without a match; thread-safe
  double residualPx = 0;    // storedResidualPx
  double bytesToMatch = 0;  // peak memory of `matches`
};

/// Counts the evidence of the views' depth. The result is in the order of the photographs. Throws Error.
std::vector<PhotographDepth> confirmDepths(const BuildInput& input, DepthSearch search, const MatchedViews& matched,
                                           const BuildJobs& jobs);

/// Depth maps in the order of the photographs. Finished maps are cached. Throws Error.
std::vector<PhotographDepth> findDepths(const BuildInput& input, DepthSearch search, const BuildOptions& options,
                                        const BuildJobs& jobs);

}  // namespace ibr
