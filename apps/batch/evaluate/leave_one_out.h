// SPDX-License-Identifier: Apache-2.0
// `ibr eval --leave-one-out`: builds a scene without each held-out photograph, renders its view and compares.
//
//   1. all builds cache depth and cells in one folder, with keys of all inputs. Results that do not depend on the
//      held-out photograph are computed once (BuildOptions::cacheFolder); own tracks depend on the photograph
//   2. if poses are refined, they are refined without the photograph; its own pose is then resected
//   3. each view's result is cached with a key of all inputs, so that an interrupted run can resume
#pragma once

#include <string>
#include <vector>

#include "batch/build/build_options.h"
#include "batch/command.h"
#include "batch/evaluate/evaluator.h"

namespace ibr::app {

struct LeaveOneOutOptions {
  std::string photographs, work;
  std::vector<std::string> views;  // names; empty: every `every`th, by name
  int every = 1;
  bool resect = false;  // true: the held-out pose is resected from points shared with the others (ibr/author/poses.h)
  std::vector<std::string> words;  // options and values of the command line that affect the scores
};

/// The truth is the photograph as a build stores it. A view that cannot be built or rendered is reported and skipped;
/// fails if all views fail. Throws Error; panoramas are unsupported.
ExitCode leaveOneOut(const LeaveOneOutOptions& options, const BuildChoices& choices,
                     const EvaluationOptions& evaluation, const Context& context);

}  // namespace ibr::app
