// SPDX-License-Identifier: Apache-2.0
// Records of a build's input for steps that read neither the model nor the headers of all photographs.
#pragma once

#include "author/build/build_input.h"
#include "author/jobs/cached_values.h"
#include "author/match/frame_depth.h"
#include "ibr/author/build.h"
#include "ibr/scene.h"

namespace ibr {

/// Records images, photographs and hashes, but no tracks. Paths are relative to the folders of the options.
void writeInputRecord(CacheWriter& out, const BuildInput& input, const BuildOptions& options);
/// The stored masks of photographs that have hashes are those of the cache folder.
BuildInput readInputRecord(CacheReader& in, const BuildOptions& options);

void writeTracks(CacheWriter& out, const std::vector<Track>& tracks);
std::vector<Track> readTracks(CacheReader& in);

/// Camera, map and step of a member's depth.
void writeMemberDepth(CacheWriter& out, const MemberDepth& depth);
MemberDepth readMemberDepth(CacheReader& in);

}  // namespace ibr
