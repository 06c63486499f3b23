// SPDX-License-Identifier: Apache-2.0
// Photographs and masks of a build, as they are stored in its scene.
#pragma once

#include <vector>

#include "author/build/build_input.h"
#include "author/jobs/build_jobs.h"
#include "author/pixels/bit_mask.h"
#include "ibr/author/build.h"
#include "ibr/scene.h"

namespace ibr {

/// Sets BuildInput::hashes. Stores masks of the stored size in the cache: there is no scene folder yet.
void hashPhotographs(BuildInput& input, const BuildOptions& options, const BuildJobs& jobs);

/// Cache file of the mask of a photograph with this hash.
std::filesystem::path cachedMask(const BuildOptions& options, std::uint64_t hash);

/// As hashPhotographs, for one photograph. Precondition: BuildInput::hashes has its size; the cache folder exists.
void hashAndCacheMask(BuildInput& input, std::uint32_t photograph, const BuildOptions& options);

/// Stores all photographs in the scene's folder, sets BuildInput::hashes, and returns the scene's nodes. Throws
/// Error{invalidInput} that names all photographs that cannot be read.
std::vector<Node> storePhotographs(BuildInput& input, const BuildOptions& options, const BuildJobs& jobs);

/// Peak memory of storing one of the photographs, bytes.
double bytesToStoreOne(const BuildInput& input);

/// Drops observations that the stored masks cover. Returns the photographs with a mask; warns if a mask may be
/// inverted.
std::vector<BuildReport::MaskReport> applyMasksToTracks(BuildInput& input, const LogCallback& log);

/// Adds `moved` (findMovers; an image or nothing for each photograph) to the photographs' masks, stores them, and
/// updates hashes and nodes.
void addMasks(BuildInput& input, std::vector<Node>& nodes, const std::vector<BitMask>& moved,
              const BuildOptions& options, const BuildJobs& jobs);

}  // namespace ibr
