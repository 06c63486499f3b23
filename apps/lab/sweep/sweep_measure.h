// SPDX-License-Identifier: Apache-2.0
// Measures settings of the optimiser on a scene: time and ECC of chosen cells, and errors in held-out views.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "batch/evaluate/evaluator.h"
#include "batch/files/truth.h"
#include "ibr/author/optimise_scene.h"
#include "lab/sweep/sweep_report.h"
#include "shared/cli/context.h"

namespace ibr::app {

struct SweepOptions {
  std::string scene, truth;
  std::vector<std::string> views;
  std::vector<std::size_t> cells;  // empty: the cells that the views show
  EvaluationOptions evaluation;
};

class SweepMeasure {
 public:
  /// Reads the scene and the views. Throws Error, also if the views show no cell.
  SweepMeasure(const SweepOptions& options, const Context& context);

  const std::vector<std::size_t>& cells() const { return options_.cells; }
  const std::vector<View>& views() const { return truth_.views(); }

  /// Returns a key of all inputs that a setting's row depends on.
  std::uint64_t keyOf(const SweepSetting& setting) const;

  /// Optimises the cells of a copy in memory, renders the views and compares them. `progress` reports this setting.
  /// Throws Error.
  SweepRow measure(const SweepSetting& setting, const ProgressCallback& progress);

 private:
  const Aligner& alignerOf(AlignmentMethod method);

  SweepOptions options_;
  const Context& context_;
  Scene scene_;
  Truth truth_;
  std::vector<Image8> pictures_;  // of the views
  std::uint64_t key_;             // of all inputs but the setting
  std::map<AlignmentMethod, Aligner> aligners_;
  bool rendered_ = false;
};

}  // namespace ibr::app
