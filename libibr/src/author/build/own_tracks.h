// SPDX-License-Identifier: Apache-2.0
// A build's tracks: those of its model, and where these are missing or few, our own (tracks.h).
#pragma once

#include "author/build/build_input.h"
#include "author/features/tracks.h"
#include "author/jobs/build_jobs.h"

namespace ibr {

const char* trackSourceName(TrackSource source);

/// Pairs of photographs for which tracks of our own are wanted.
std::vector<ImagePair> pairsForTracks(const PosedModel& model, TrackSource source);

/// Finds tracks for pairs of photographs that lack them. Precondition: the photographs are stored. Throws Error (io,
/// cancelled).
void addOwnTracks(BuildInput& input, const BuildOptions& options, const BuildJobs& jobs, const LogCallback& log);

}  // namespace ibr
