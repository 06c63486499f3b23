// SPDX-License-Identifier: Apache-2.0
// Depth of all photographs of a build.
#pragma once

#include <vector>

#include "author/build/build_input.h"
#include "author/depth/photograph_depth.h"
#include "author/jobs/build_jobs.h"
#include "ibr/author/build.h"

namespace ibr {

/// Depth maps in the order of the photographs. Finished maps are cached. Throws Error.
std::vector<PhotographDepth> findDepths(const BuildInput& input, DepthSearch search, const BuildOptions& options,
                                        const BuildJobs& jobs);

}  // namespace ibr
