// SPDX-License-Identifier: Apache-2.0
// What a build starts from: its options checked, the model read, the photographs found.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "author/photographs/photographs.h"
#include "base/hash.h"
#include "ibr/author.h"
#include "ibr/log.h"

namespace ibr {

struct BuildInput {
  PosedModel model;
  std::vector<std::vector<std::uint32_t>> tracksOf;  // of each image: its tracks, ascending
  std::vector<Photograph> photographs;               // of model.images
  std::vector<std::uint64_t> hashes;                 // of their files, once they are stored
  bool refine = false;                               // poses are estimates: matches are refined beyond them
  std::vector<UnusedPhotograph> unknown;             // files that the model does not know
};

/// Throws Error (io, invalidInput) that names the option.
void checkOptions(const BuildOptions& options);

/// Throws Error (io, invalidInput) that names the option or the file; nothing is written.
BuildInput readInput(const BuildOptions& options, const LogCallback& log);

bool isPanorama(const Photograph& photograph);

/// Finished cells wait here until the scene is written, or for the next build.
std::filesystem::path keptFolder(const BuildOptions& options);

/// What a cell or a backdrop depends on.
void addPhotograph(Hash& hash, const BuildInput& input, std::uint32_t photograph);
void addPoints(Hash& hash, const std::vector<glm::dvec3>& points);

}  // namespace ibr
