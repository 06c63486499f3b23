// SPDX-License-Identifier: Apache-2.0
// Predicted time and memory of the steps of a build, from the prediction of the whole build.
#pragma once

#include <cstddef>

#include "author/build/build_input.h"
#include "author/graph/cells.h"
#include "author/steps/step_files.h"
#include "ibr/author/build.h"

namespace ibr {

struct StepCost {
  double seconds = 0;  // of processor time
  double memory = 0;   // peak with one thread, bytes
};

class StepCosts {
 public:
  /// `plan`: null if the cells are unknown, because tracks are yet to be found. `pairs`: that need own tracks. Runs a
  /// short benchmark.
  StepCosts(const BuildInput& input, const BuildOptions& options, const CellPlan* plan,
            const std::vector<ImagePair>& pairs);

  StepCost model() const;
  StepCost photographs(const Batch& batch) const;
  StepCost matches(std::size_t pairs) const;
  StepCost tracks() const;
  StepCost depth(const Batch& batch) const;
  StepCost confirmed() const;
  StepCost cells(const Batch& batch) const;
  StepCost scene() const;

 private:
  double secondsOf(const char* stage) const;
  double shareOf(const Batch& batch) const;

  const BuildInput& input_;
  const BuildOptions& options_;
  const CellPlan* plan_;
  std::vector<bool> needsFeatures_;  // of each photograph
  std::size_t pairs_ = 0, featured_ = 0;
  double modelBytes_ = 0;  // resident memory with the model, bytes
  double reading_ = 0;     // processor time of reading the model, s
  BuildPrediction whole_;
  double loading_ = 0, features_ = 0, sweeping_ = 0, viewBytes_ = 0, depthBytes_ = 0, cellBytes_ = 0;  // of one job
};

}  // namespace ibr
