// SPDX-License-Identifier: Apache-2.0
// Runs one step of a build (ibr/author/build_steps.h).
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "author/jobs/build_jobs.h"
#include "author/steps/step_files.h"
#include "ibr/author/build.h"
#include "ibr/log.h"

namespace ibr {

/// Throws Error{invalidInput} for options that steps do not support.
void checkStepOptions(const BuildOptions& options);
/// Throws Error{invalidInput} if a build would refine the poses.
void checkPosesKept(const BuildInput& input);

class StepRunner {
 public:
  /// All arguments must outlive the object.
  StepRunner(const BuildOptions& options, std::size_t photographsPerStep, const ProgressCallback& progress,
             const LogCallback& log);

  void findModel() const;                         // "model"
  void readPhotographs(std::size_t batch) const;  // "photographs-N": hashes, masks, features
  void matchFeatures(std::size_t batch) const;    // "matches-N"
  void planTracks() const;                        // "tracks"
  void findDepth(std::size_t batch) const;        // "depth-N"
  void confirmDepth() const;                      // "confirmed"
  void makeCells(std::size_t batch) const;        // "cells-N"

 private:
  std::vector<Batch> batches(const BuildInput& input) const;
  Batch batchOf(const BuildInput& input, std::size_t index) const;
  // Hashes of all photographs, from the outputs of the steps "photographs-N".
  PhotographHashes allHashes(const BuildInput& input) const;
  bool isConfirmed(const std::string& source) const;
  // Throws Error{io} that names a photograph whose bytes have changed.
  void checkUnchanged(const PlannedBuild& build, const std::vector<std::uint32_t>& photographs) const;

  const BuildOptions& options_;
  const std::size_t photographsPerStep_;
  const std::uint64_t key_;
  const BuildJobs jobs_;
  const LogCallback& log_;
};

}  // namespace ibr
