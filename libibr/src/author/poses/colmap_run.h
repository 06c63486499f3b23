// SPDX-License-Identifier: Apache-2.0
// One run of COLMAP in its cached folder: the photographs of the run, the run's files, and the models that it finds.
// Indices are into ColmapPhotographs::names.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "author/poses/colmap_photographs.h"
#include "author/poses/colmap_program.h"
#include "ibr/author/poses.h"
#include "ibr/log.h"

namespace ibr {

struct ColmapRun {
  std::vector<std::size_t> added;        // photographs added to the existing model, ascending; empty: a new estimate
  std::vector<std::size_t> photographs;  // photographs of this run: `added`, or all
  std::string mark;                      // prefix of this run's files
  std::filesystem::path databaseFile;    // COLMAP's database of this run
  std::filesystem::path listFile;        // names of the photographs of this run, one a line
};

/// COLMAP reads pairs of names word by word: false if a name has a space.
bool isReadInPairs(const std::vector<std::string>& names);

/// Prepares options.folder for a run, or for the rest of a stopped run. Discards results of other photographs or
/// settings, except poses to which a few photographs are only added. Checks the photographs of a new run
/// (checkColmapPhotographs). Throws Error: invalidInput, too, if the folder has other files; io; cancelled.
ColmapRun prepareColmapRun(const PoseOptions& options, const ColmapPhotographs& photographs,
                           const ColmapProgram& colmap, const ProgressCallback& progress);

/// Returns the folders of the models in options.folder, sorted; empty if there are none.
std::vector<std::filesystem::path> colmapModels(const PoseOptions& options);

/// Returns the model with the most registered photographs; `registered` is 0 if there is none. `photographs`: number of
/// photographs, for the report.
PoseReport largestColmapModel(const PoseOptions& options, std::size_t photographs);

}  // namespace ibr
