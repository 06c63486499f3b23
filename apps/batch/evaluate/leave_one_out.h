// SPDX-License-Identifier: Apache-2.0
// `ibr eval --leave-one-out`: a scene is built without each held-out photograph, its view rendered and compared.
//
//   1. depths and cells are finished in one folder for all builds, under keys that say all that they depend on: what
//      the photograph takes no part in is made once (BuildOptions::finishedCells); tracks of our own change with it
//   2. where poses are refined, they are so without the photograph, too, which is then resected among them
//   3. what came of a view is kept, under a key of all that it depends on: an interrupted run goes on
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
  bool resect =
      false;  // its camera is found anew, by the points that it shares with the others (author/poses/resect.h)
  std::vector<std::string> words;  // of the command line, that scores depend on: options and their values
};

/// The truth is the photograph as a build stores it. A view that cannot be built or rendered is reported and the rest
/// goes on, unless all fail. Throws Error; panoramas are unsupported.
ExitCode leaveOneOut(const LeaveOneOutOptions& options, const BuildChoices& choices,
                     const EvaluationOptions& evaluation, const Context& context);

}  // namespace ibr::app
