// SPDX-License-Identifier: Apache-2.0
#include "author/build/own_tracks.h"

#include <fmt/format.h>

#include "author/build/cell_maker.h"
#include "author/geometry/posed_model.h"

namespace ibr {
namespace {

// Px. As kExactPx, but for own features, which are located to about 0.13 px.
constexpr double kExactByFeaturesPx = 0.2;

}  // namespace

const char* trackSourceName(TrackSource source) {
  return source == TrackSource::automatic ? "auto" : source == TrackSource::model ? "model" : "own";
}

std::vector<ImagePair> pairsForTracks(const PosedModel& model, TrackSource source) {
  if (source == TrackSource::model) return {};
  if (source == TrackSource::own) return pairsWithoutTracks({model.images, {}}, {});
  PairOptions wanted;
  // In a model with tracks, distant pairs that share few tracks were already tried: matches only 5 neighbours.
  if (!model.tracks.empty()) wanted.neighbours = 5;
  return pairsWithoutTracks(model, wanted);
}

OwnTracksInput ownTracksInput(const BuildInput& input, const BuildOptions& options) {
  OwnTracksInput own;
  own.cacheFolder = buildCacheFolder(options);
  own.view = [&](std::size_t i) { return viewOf(input.photographs[i]); };
  for (std::uint32_t i = 0; i < input.photographs.size(); ++i) {
    own.cameras.push_back(matchedCamera(input.photographs[i].camera));
    own.bytesOfView = std::max(own.bytesOfView, bytesToLoad(input.photographs[i]));
    Hash hash;
    addPhotograph(hash, input, i);
    own.hashes.push_back(hash.value());
  }
  return own;
}

void addOwnTracks(BuildInput& input, const BuildOptions& options, const BuildJobs& jobs, const LogCallback& log) {
  if (options.tracks == TrackSource::model || (options.draft && !input.model.tracks.empty())) return;
  if (options.tracks == TrackSource::own) {
    input.model.tracks.clear();
    input.tracksOf = tracksOfImages(input.model);
  }
  const std::vector<ImagePair> pairs = pairsForTracks(input.model, options.tracks);
  if (pairs.empty()) return;
  const OwnTracksInput own = ownTracksInput(input, options);
  const bool none = input.model.tracks.empty();
  PosedModel found{input.model.images, {}};
  found.tracks =
      makeTracks(input.model, pairs, own,
                 [&](std::string_view stage, std::size_t count, double bytesEach,
                     const std::function<void(std::size_t)>& job) { jobs.runAll(stage, count, bytesEach, job); });
  const double error = reprojectionError(found);
  if (log)
    log(LogLevel::info,
        fmt::format(
            "{} pairs of photographs have few tracks or none: found {} own tracks with a median reprojection error of "
            "{:.2f} px",
            pairs.size(), found.tracks.size(), error));
  input.model.tracks.insert(input.model.tracks.end(), std::make_move_iterator(found.tracks.begin()),
                            std::make_move_iterator(found.tracks.end()));
  input.tracksOf = tracksOfImages(input.model);
  if (none) input.refine = error > kExactByFeaturesPx;
}

}  // namespace ibr
