// SPDX-License-Identifier: Apache-2.0
// Tracks of our own, where a model has none: SIFT guided by the poses.
//
//   1. pairs that may see the same: photographs near each other that look alike ways; not all of n²
//   2. features of each photograph, matches of each pair (features.h, epipolar.h)
//   3. the matches' graph, the most alike first, joined to tracks that have one feature a photograph
//   4. each track triangulated; what is more than 2 px off, or behind a camera, is left out
//
// Features and matches are kept in a folder, so that memory holds those of two photographs a thread, and a build that
// was stopped goes on.
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
#include "ibr/author.h"

namespace ibr {

using ImagePair = std::pair<std::uint32_t, std::uint32_t>;  // first < second

struct PairOptions {
  std::size_t neighbours = 10;  // of a photograph, nearest first, with a place of their own
  double angleDegrees = 50;     // between axes, at most
  std::size_t enough = 150;     // tracks that a pair shares and needs no more
};

/// Pairs of pinholes that may see the same and share fewer tracks of the model than are enough; sorted.
std::vector<ImagePair> pairsWithoutTracks(const PosedModel& model, const PairOptions& options = {});

/// The world point that rays see best: least squares in px. nullopt where it is behind one of them or at infinity.
std::optional<glm::dvec3> triangulate(std::span<const Camera> cameras, std::span<const glm::dvec2> pixels);

inline constexpr double kFeaturePixels = 2e6;         // features are looked for in no more than this
inline constexpr double kFeatureBytesPerPixel = 300;  // of memory that finding them takes

struct OwnTracksInput {
  std::function<MatchView(std::size_t)> view;  // a photograph at the size that features are looked for at; thread-safe
  std::vector<Camera> cameras;                 // of the views
  double bytesOfView = 0;                      // of memory that `view` takes at most
  std::vector<std::uint64_t> hashes;           // that tell photographs and their cameras apart
  std::filesystem::path keep;                  // folder that is there
};

/// Runs jobs (parallel.h) under the name of a stage; `bytesEach`: of memory that one takes.
using RunJobs = std::function<void(std::string_view stage, std::size_t count, double bytesEach,
                                   const std::function<void(std::size_t)>& job)>;

/// Tracks of the pairs, their pixels in the model's cameras; in an order that depends on nothing but the input.
std::vector<Track> makeTracks(const PosedModel& model, std::span<const ImagePair> pairs, const OwnTracksInput& input,
                              const RunJobs& run);

/// Step 3: features that stand for one point. matches[p] are those of pairs[p].
std::vector<std::vector<std::pair<std::uint32_t, std::uint32_t>>> joinMatches(
    std::span<const ImagePair> pairs, std::span<const std::vector<FeatureMatch>> matches);

}  // namespace ibr
