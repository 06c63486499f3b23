// SPDX-License-Identifier: Apache-2.0
// Tracks of a build: those of its model and, for pairs that lack them, own tracks (tracks.h).
#pragma once

#include "author/build/build_input.h"
#include "author/features/tracks.h"
#include "author/jobs/build_jobs.h"

namespace ibr {

const char* trackSourceName(TrackSource source);

/// Pairs of photographs that need own tracks.
std::vector<ImagePair> pairsForTracks(const PosedModel& model, TrackSource source);

/// Photographs, cameras, hashes and cache folder for the functions of tracks.h. Both arguments must outlive the result.
/// Precondition: BuildInput::hashes has one element per photograph.
OwnTracksInput ownTracksInput(const BuildInput& input, const BuildOptions& options);

/// Finds tracks for pairs of photographs that lack them. Precondition: the photographs are stored. Throws Error (io,
/// cancelled).
void addOwnTracks(BuildInput& input, const BuildOptions& options, const BuildJobs& jobs, const LogCallback& log);

}  // namespace ibr
