// SPDX-License-Identifier: Apache-2.0
// Own tracks for models that lack them: SIFT features, matched along the epipolar lines of the poses.
//
//   1. candidate pairs: nearby photographs with similar directions; not all of n²
//   2. features of each photograph, matches of each pair (features.h, epipolar.h)
//   3. matches joined to tracks, most similar first; a track has at most one feature per photograph
//   4. each track triangulated; observations off by over 2 px, or behind a camera, are dropped
//
// Features and matches are cached in a folder. Memory holds those of two photographs per thread, and a stopped build
// resumes.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "author/features/epipolar.h"
#include "author/geometry/match_view.h"
#include "ibr/author/poses.h"

namespace ibr {

using ImagePair = std::pair<std::uint32_t, std::uint32_t>;  // first < second

struct PairOptions {
  std::size_t neighbours = 10;  // per photograph, nearest first, at other positions
  double angleDegrees = 50;     // max angle between axes
  std::size_t enough = 150;     // a pair that shares so many tracks needs no more
};

/// Pairs of pinholes that may overlap and share fewer of the model's tracks than `enough`; sorted.
std::vector<ImagePair> pairsWithoutTracks(const PosedModel& model, const PairOptions& options = {});

inline constexpr double kFeaturePixels = 2e6;         // max px of an image in which features are searched
inline constexpr double kFeatureBytesPerPixel = 300;  // memory of the feature search

struct OwnTracksInput {
  std::function<MatchView(std::size_t)> view;  // a photograph at the size of the feature search; thread-safe
  std::vector<Camera> cameras;                 // of the views
  double bytesOfView = 0;                      // peak memory of `view`
  std::vector<std::uint64_t> hashes;           // identify photographs and their cameras
  std::filesystem::path cacheFolder;           // existing cache folder
};

/// Runs jobs (parallel.h) as the stage `stage`; `bytesEach`: memory of one job.
using RunJobs = std::function<void(std::string_view stage, std::size_t count, double bytesEach,
                                   const std::function<void(std::size_t)>& job)>;

/// Finds and caches the features of a photograph, unless they are cached. Thread-safe. Throws what `view` throws, and
/// Error{io}.
void findFeatures(const OwnTracksInput& input, std::uint32_t photograph);

/// Peak memory of findFeatures, bytes, for photographs of up to `pixels` px.
double bytesToFindFeatures(const OwnTracksInput& input, double pixels);

/// Matches the cached features of a pair, or reads the matches from the cache. Thread-safe. Throws Error{io} if the
/// features are not cached.
std::vector<FeatureMatch> matchesOf(const OwnTracksInput& input, ImagePair pair);
/// Cache file of the matches.
std::filesystem::path matchesFile(const OwnTracksInput& input, ImagePair pair);
inline constexpr double kBytesToMatchPair = 24e6;  // peak memory of matchesOf

/// Tracks of the pairs, with pixels in the model's cameras. Deterministic, including their order.
std::vector<Track> makeTracks(const PosedModel& model, std::span<const ImagePair> pairs, const OwnTracksInput& input,
                              const RunJobs& run);

/// Step 3: sets of (photograph, feature) that belong to one point. matches[p]: of pairs[p].
std::vector<std::vector<std::pair<std::uint32_t, std::uint32_t>>> joinMatches(
    std::span<const ImagePair> pairs, std::span<const std::vector<FeatureMatch>> matches);

}  // namespace ibr
