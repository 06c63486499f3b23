// SPDX-License-Identifier: Apache-2.0
// Predicts the cost of a build from its input: counts the work, and converts it to time, memory and disk space of this
// machine (build_cost.h).
#pragma once

#include "author/build/build_input.h"
#include "author/graph/cells.h"
#include "ibr/author/build.h"

namespace ibr {

/// `plan`: nullptr if tracks are not found yet; the number of cells is then assumed to be that of the photographs.
/// Takes some tenths of a second.
BuildPrediction predictBuild(const BuildInput& input, const BuildOptions& options, const CellPlan* plan);

/// Prediction before poses are known, from the files alone.
BuildPrediction predictWithoutPoses(const BuildOptions& options);

/// Throws Error{io} if the disk cannot hold even what is certain to be written. Warns if the disk may be too small, and
/// if one cell takes more memory than allowed.
void checkDiskSpace(const BuildPrediction& prediction, const BuildOptions& options, const LogCallback& log);

}  // namespace ibr
