// SPDX-License-Identifier: Apache-2.0
// Poses and focal lengths that agree better, by what matching says about all photographs. Needs ibr::author.
#pragma once

#include "ibr/author.h"

namespace ibr {

struct RefinedModel {
  PosedModel model;           // with the tracks that the build had, our own included
  PoseRefinement refinement;  // no photograph moved: poses are kept; the model is as it was
};

/// Matches the cells of a build with these options and refines poses by them, where they are estimates: where the
/// model's points reproject exactly, all stays, and where refined poses do not suit points better that they were not
/// refined by. For builds that are to have them: write the model and name it. Of the output only the finished cells are
/// written, or `finishedCells`. Throws Error as build.
RefinedModel refinedModel(const BuildOptions& options, const ProgressCallback& progress = {},
                          const LogCallback& log = {});

}  // namespace ibr
