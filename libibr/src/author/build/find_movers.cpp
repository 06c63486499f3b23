// SPDX-License-Identifier: Apache-2.0
#include "author/build/find_movers.h"

#include <algorithm>
#include <map>
#include <utility>

#include "author/build/cell_maker.h"
#include "author/geometry/posed_model.h"
#include "author/movers/movers.h"
#include "author/movers/settle_movers.h"
#include "author/photographs/masks.h"

namespace ibr {
namespace {

constexpr std::size_t kMinSharedTracks = 20;  // of photographs that are compared
constexpr double kBytesPerPixel = 200;        // per matched pixel of a photograph, while it is compared

ComparedView compareWithOthers(const BuildInput& input, const PhotographDepth& depth,
                               const std::vector<std::uint32_t>& comparisons) {
  std::vector<std::uint32_t> members{depth.node};
  members.insert(members.end(), comparisons.begin(), comparisons.end());
  const std::vector<Camera> cameras = camerasToMatch(input, members);
  std::vector<MatchView> views;
  for (std::size_t i = 0; i < members.size(); ++i) {
    views.push_back(viewOf(input.photographs[members[i]]));
    views.back().camera = cameras[i];
  }
  ComparedView result{
      {}, comparisons, differingRegions(views[0], std::span(views).subspan(1), depth.matched.map.inverseDepth)};
  result.camera = {resized(cameras[0].intrinsics, result.found.width, result.found.height), cameras[0].pose};
  return result;
}

}  // namespace

std::vector<std::vector<std::uint32_t>> comparisonPhotographs(const BuildInput& input) {
  const std::size_t count = input.photographs.size();
  std::vector<std::map<std::uint32_t, std::size_t>> shared(count);
  for (const Track& track : input.model.tracks)
    for (const TrackObservation& a : track.observations)
      for (const TrackObservation& b : track.observations)
        if (a.image != b.image) ++shared[a.image][b.image];
  std::vector<std::vector<std::uint32_t>> comparisons(count);
  for (std::uint32_t i = 0; i < count; ++i) {
    if (isPanorama(input.photographs[i])) continue;
    std::vector<std::pair<std::size_t, std::uint32_t>> best;
    for (const auto& [other, tracks] : shared[i])
      if (tracks >= kMinSharedTracks && !isPanorama(input.photographs[other])) best.emplace_back(tracks, other);
    std::ranges::sort(best, [](const auto& a, const auto& b) {
      return a.first != b.first ? a.first > b.first : a.second < b.second;
    });
    for (const auto& [tracks, other] : best)
      if (comparisons[i].size() < kMaxComparisons) comparisons[i].push_back(other);
  }
  return comparisons;
}

double bytesToCompare(const Photograph& photograph) {
  const Intrinsics& k = photograph.camera.intrinsics;
  return bytesToLoad(photograph) + kBytesPerPixel * std::min(double(k.width) * k.height, kMatchPixels);
}

std::vector<BitMask> findMovers(const BuildInput& input, std::span<const PhotographDepth> depths,
                                const BuildJobs& jobs) {
  const std::vector<std::vector<std::uint32_t>> comparisons = comparisonPhotographs(input);
  double bytes = 0;
  for (const Photograph& photo : input.photographs) bytes = std::max(bytes, bytesToCompare(photo));
  std::vector<ComparedView> views(comparisons.size());
  jobs.runAll("finding moving objects", comparisons.size(), bytes, [&](std::size_t i) {
    if (!comparisons[i].empty()) views[i] = compareWithOthers(input, depths[i], comparisons[i]);
  });
  return resolveMoverMasks(views);
}

Image8 maskOf(const BitMask& moved, int width, int height) {
  Image8 mask(moved.width(), moved.height(), 1, 255);
  for (int y = 0; y < moved.height(); ++y)
    for (int x = 0; x < moved.width(); ++x)
      if (moved.at(x, y)) mask.pixel(x, y)[0] = 0;
  return resizedMask(mask, width, height);
}

}  // namespace ibr
