// SPDX-License-Identifier: Apache-2.0
// What a build that has been read will take: its work counted, priced (build_cost.h), and what there is for it.
#pragma once

#include "author/build/build_input.h"
#include "author/graph/cells.h"
#include "ibr/author.h"

namespace ibr {

/// `plan`: nullptr where tracks are found only later; then as many cells as photographs are supposed. Takes some tenths
/// of a second.
BuildPrediction predictBuild(const BuildInput& input, const BuildOptions& options, const CellPlan* plan);

/// Before there are poses: from the files alone.
BuildPrediction predictWithoutPoses(const BuildOptions& options);

/// Throws Error{io} where the disk cannot hold even what is certain, and warns where it may not; warns where one cell
/// takes more memory than is allowed.
void checkRoom(const BuildPrediction& prediction, const BuildOptions& options, const LogCallback& log);

}  // namespace ibr
