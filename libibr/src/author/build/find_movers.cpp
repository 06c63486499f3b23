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

constexpr std::size_t kLeastShared = 20;  // tracks
constexpr double kBytesPerPixel = 200;    // per matched pixel of a photograph, while it is compared

JudgedView judged(const BuildInput& input, const PhotographDepth& depth, const std::vector<std::uint32_t>& judges) {
  std::vector<std::uint32_t> members{depth.node};
  members.insert(members.end(), judges.begin(), judges.end());
  const std::vector<Camera> cameras = camerasToMatch(input, members);
  std::vector<MatchView> views;
  for (std::size_t i = 0; i < members.size(); ++i) {
    views.push_back(viewOf(input.photographs[members[i]]));
    views.back().camera = cameras[i];
  }
  JudgedView result{{}, judges, oddRegions(views[0], std::span(views).subspan(1), depth.matched.map.inverseDepth)};
  result.camera = {resized(cameras[0].intrinsics, result.odd.width, result.odd.height), cameras[0].pose};
  return result;
}

}  // namespace

std::vector<std::vector<std::uint32_t>> judgesOf(const BuildInput& input) {
  const std::size_t count = input.photographs.size();
  std::vector<std::map<std::uint32_t, std::size_t>> shared(count);
  for (const Track& track : input.model.tracks)
    for (const TrackObservation& a : track.observations)
      for (const TrackObservation& b : track.observations)
        if (a.image != b.image) ++shared[a.image][b.image];
  std::vector<std::vector<std::uint32_t>> judges(count);
  for (std::uint32_t i = 0; i < count; ++i) {
    if (isPanorama(input.photographs[i])) continue;
    std::vector<std::pair<std::size_t, std::uint32_t>> best;
    for (const auto& [other, tracks] : shared[i])
      if (tracks >= kLeastShared && !isPanorama(input.photographs[other])) best.emplace_back(tracks, other);
    std::ranges::sort(best, [](const auto& a, const auto& b) {
      return a.first != b.first ? a.first > b.first : a.second < b.second;
    });
    for (const auto& [tracks, other] : best)
      if (judges[i].size() < kMostJudges) judges[i].push_back(other);
  }
  return judges;
}

double bytesToJudge(const Photograph& photograph) {
  const Intrinsics& k = photograph.camera.intrinsics;
  return bytesToLoad(photograph) + kBytesPerPixel * std::min(double(k.width) * k.height, kMatchPixels);
}

std::vector<BitMask> findMovers(const BuildInput& input, std::span<const PhotographDepth> depths,
                                const BuildJobs& jobs) {
  const std::vector<std::vector<std::uint32_t>> judges = judgesOf(input);
  double bytes = 0;
  for (const Photograph& photo : input.photographs) bytes = std::max(bytes, bytesToJudge(photo));
  std::vector<JudgedView> views(judges.size());
  jobs.runAll("finding moving objects", judges.size(), bytes, [&](std::size_t i) {
    if (!judges[i].empty()) views[i] = judged(input, depths[i], judges[i]);
  });
  return settleMovers(views);
}

Image8 maskOf(const BitMask& moved, int width, int height) {
  Image8 mask(moved.width(), moved.height(), 1, 255);
  for (int y = 0; y < moved.height(); ++y)
    for (int x = 0; x < moved.width(); ++x)
      if (moved.at(x, y)) mask.pixel(x, y)[0] = 0;
  return resizedMask(mask, width, height);
}

}  // namespace ibr
