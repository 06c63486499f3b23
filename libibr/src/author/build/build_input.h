// SPDX-License-Identifier: Apache-2.0
// Input of a build: checks the options, reads the model and finds the photographs.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "author/photographs/photographs.h"
#include "base/hash.h"
#include "ibr/author/build.h"
#include "ibr/log.h"

namespace ibr {

struct BuildInput {
  PosedModel model;
  std::vector<std::vector<std::uint32_t>> tracksOf;  // for each image: its tracks, ascending
  std::vector<Photograph> photographs;               // in the order of model.images
  std::vector<std::uint64_t> hashes;                 // of the photographs' files, set once they are stored
  bool refine = false;                               // poses are estimates: matches are refined beyond them
  bool refinesPoses = false;                         // BuildOptions::refinePoses, decided
  std::vector<UnusedPhotograph> unknown;             // files that are not in the model
};

/// Throws Error (io, invalidInput) that names the option.
void checkOptions(const BuildOptions& options);
/// Throws Error{invalidInput} if a scene would be written into the folder of its photographs.
void checkOutputFolder(const BuildOptions& options);

/// Throws Error (io, invalidInput) that names the option or the file. Writes nothing.
BuildInput readInput(const BuildOptions& options, const LogCallback& log);

bool isPanorama(const Photograph& photograph);

/// Folder that caches finished depth, cells, backdrops and features, for a resumed or a later build.
std::filesystem::path buildCacheFolder(const BuildOptions& options);

/// Adds to the hash of a cache file: the file, camera and orientation of a photograph; points.
void addPhotograph(Hash& hash, const BuildInput& input, std::uint32_t photograph);
void addPoints(Hash& hash, const std::vector<glm::dvec3>& points);

}  // namespace ibr
