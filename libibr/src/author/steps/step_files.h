// SPDX-License-Identifier: Apache-2.0
// Outputs of the steps: files in the folder ".build/steps" of the scene. They hold the plan of the build, and name the
// cache files that a step made.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "author/build/build_input.h"
#include "author/build/sweep_plan.h"
#include "author/features/tracks.h"
#include "author/graph/cells.h"
#include "ibr/author/build.h"

namespace ibr {

/// Consecutive photographs that one step handles.
struct Batch {
  std::size_t index = 0, begin = 0, end = 0;  // photographs begin … end − 1
};
std::vector<Batch> batchesOf(std::size_t photographs, std::size_t photographsPerStep);

/// Identifies the options that the results of steps depend on.
std::uint64_t optionsKey(const BuildOptions& options, std::size_t photographsPerStep);

std::filesystem::path stepFile(const BuildOptions& options, const std::string& step);
/// "depth-0003"
std::string batchStep(const char* kind, std::size_t batch);

/// Output of the step "model".
struct StepModel {
  BuildInput input;              // without tracks and hashes
  std::vector<ImagePair> pairs;  // that need own tracks
  std::uint64_t hash = 0;        // of the model with its tracks
};
void storeModel(const BuildOptions& options, std::uint64_t key, const StepModel& model);
StepModel fetchModel(const BuildOptions& options, std::uint64_t key);

/// Output of a step "photographs-N".
struct PhotographHashes {
  std::vector<std::uint64_t> photographs;  // BuildInput::hashes
  std::vector<std::uint64_t> files;        // of the photographs' bytes
};
void storeHashes(const BuildOptions& options, std::uint64_t key, std::size_t batch, const PhotographHashes& hashes);
PhotographHashes fetchHashes(const BuildOptions& options, std::uint64_t key, std::size_t batch);

/// Output of the step "tracks": the plan of depth and cells, of which each step reads its own part.
struct PlannedBuild {
  BuildInput input;  // without tracks
  std::vector<std::uint64_t> files;
  double residualPx = 0;     // storedResidualPx
  std::uint64_t source = 0;  // identifies model, photographs and options
};
struct PlannedBatch {
  std::vector<std::optional<ViewSweep>> sweeps;  // of the views of the batch's photographs
  std::vector<std::vector<glm::dvec3>> points;   // of each photograph; empty if all of its views have sweeps
  std::vector<CellMembers> cells;                // whose first member is in the batch
  std::vector<Track> tracks;                     // that the members of the cells observe
};
void storePlan(const BuildOptions& options, std::uint64_t key, const PlannedBuild& build,
               const std::vector<PlannedBatch>& batches);
PlannedBuild fetchPlan(const BuildOptions& options, std::uint64_t key);
PlannedBatch fetchPlannedBatch(const BuildOptions& options, std::uint64_t key, std::size_t batch);
/// PlannedBuild::source of a valid plan; nullopt without one.
std::optional<std::uint64_t> plannedSource(const BuildOptions& options, std::uint64_t key);

/// Names of the cache files that a step made, one a line. "" stands for none.
void storeNames(const BuildOptions& options, const std::string& step, const std::vector<std::string>& names);
std::vector<std::string> fetchNames(const BuildOptions& options, const std::string& step);

}  // namespace ibr
