// SPDX-License-Identifier: Apache-2.0
// The plan of depth and cells, made once by the step "tracks", in parts for the steps that follow.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "author/build/build_input.h"
#include "author/jobs/build_jobs.h"
#include "author/steps/step_files.h"

namespace ibr {

/// Plans the cells and the sweeps of all photographs. Precondition: `input` has all tracks, own ones included.
std::vector<PlannedBatch> planBatches(const BuildInput& input, const BuildOptions& options,
                                      std::span<const Batch> batches, const BuildJobs& jobs);

/// Sweeps of all views. `views`: of each batch in their order.
std::vector<std::optional<ViewSweep>> joinedSweeps(std::span<const PlannedBatch> batches);

/// Hash of the images, their cameras and the tracks.
std::uint64_t modelHash(const PosedModel& model);

}  // namespace ibr
