// SPDX-License-Identifier: Apache-2.0
// Exposures and vignetting of a build's photographs, from their depth.
#pragma once

#include <vector>

#include "author/build/build_input.h"
#include "author/depth/photograph_depth.h"
#include "author/jobs/build_jobs.h"
#include "ibr/author/build.h"
#include "ibr/scene.h"

namespace ibr {

/// Measures what the options request: sets Node::gain, and removes vignetting from the stored photographs.
BuildReport::ExposureSummary measureExposures(BuildInput& input, std::vector<Node>& nodes,
                                              const std::vector<PhotographDepth>& depths, const BuildOptions& options,
                                              const BuildJobs& jobs);

}  // namespace ibr
