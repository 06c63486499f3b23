// SPDX-License-Identifier: Apache-2.0
#include "author/sweep/homographies.h"

#include <algorithm>
#include <glm/geometric.hpp>
#include <random>

namespace ibr {
namespace {

constexpr int kSamples = 160;
constexpr std::size_t kNear = 16, kWide = 80;  // neighbours from which a sample is drawn
constexpr int kMaxGrowthSteps = 6;
constexpr std::size_t kMaxScoredTracks = 1500;  // maximum tracks for scoring samples; the winner is counted on all

std::vector<const PlaneTrack*> inliersOf(const PlaneMaps& plane, std::span<PlaneTrack* const> tracks, double limit) {
  std::vector<const PlaneTrack*> inliers;
  for (const PlaneTrack* track : tracks)
    if (plane.error(*track) < limit) inliers.push_back(track);
  return inliers;
}

// Refits the plane to its inliers until their number stops growing.
void grow(const PlaneFitter& fit, std::span<PlaneTrack* const> tracks, PlaneMaps& plane,
          std::vector<const PlaneTrack*>& inliers) {
  inliers = inliersOf(plane, tracks, kMaxPlaneErrorPx);
  for (int round = 0; round < kMaxGrowthSteps; ++round) {
    // A plane fitted to few neighbours is slightly off farther away: the first rounds use a wider tolerance.
    const std::vector<const PlaneTrack*> wide =
        inliersOf(plane, tracks, round < 2 ? 2 * kMaxPlaneErrorPx : kMaxPlaneErrorPx);
    const std::optional<PlaneMaps> next = fit(wide);
    if (!next) return;
    std::vector<const PlaneTrack*> found = inliersOf(*next, tracks, kMaxPlaneErrorPx);
    if (found.size() < inliers.size() || (round >= 2 && found.size() == inliers.size())) return;
    plane = *next;
    inliers = std::move(found);
  }
}

}  // namespace

bool sealLargestPlane(const PlaneFitter& fit, std::span<PlaneTrack> tracks, std::vector<PlaneMaps>& planes,
                      std::uint64_t seed) {
  std::vector<PlaneTrack*> rest;
  for (PlaneTrack& track : tracks)
    if (track.plane < 0) rest.push_back(&track);
  if (rest.size() < minOnPlane(fit) || planes.size() >= kMaxPlanes) return false;

  std::mt19937_64 random(seed);
  std::vector<PlaneTrack*> scored;
  const std::size_t stride = (rest.size() + kMaxScoredTracks - 1) / kMaxScoredTracks;
  for (std::size_t t = 0; t < rest.size(); t += stride) scored.push_back(rest[t]);

  std::vector<std::pair<double, std::size_t>> near(rest.size());
  PlaneMaps best;
  std::vector<const PlaneTrack*> bestInliers;
  std::size_t mostRaw = 0;
  for (int sample = 0; sample < kSamples; ++sample) {
    const std::size_t first = random() % rest.size();
    const std::size_t wanted = std::min(sample % 2 ? kNear : kWide, rest.size() - 1);
    for (std::size_t t = 0; t < rest.size(); ++t) {
      const glm::dvec2 off = rest[t]->at[0] - rest[first]->at[0];
      near[t] = {glm::dot(off, off), t};
    }
    std::nth_element(near.begin(), near.begin() + std::ptrdiff_t(wanted), near.end());
    // Sort for a defined order: nth_element's differs between libraries.
    std::sort(near.begin(), near.begin() + std::ptrdiff_t(wanted) + 1);
    std::vector<const PlaneTrack*> drawn{rest[first]};
    for (int tries = 0; tries < 20 && drawn.size() < fit.minTracks(); ++tries) {
      const PlaneTrack* other = rest[near[random() % (wanted + 1)].second];
      if (std::ranges::find(drawn, other) == drawn.end()) drawn.push_back(other);
    }
    std::optional<PlaneMaps> plane = fit(drawn);
    if (!plane) continue;
    // Growing is expensive: only samples with more raw inliers than all earlier ones are grown.
    std::vector<const PlaneTrack*> inliers = inliersOf(*plane, scored, 2 * kMaxPlaneErrorPx);
    if (inliers.size() <= mostRaw) continue;
    mostRaw = inliers.size();
    grow(fit, scored, *plane, inliers);
    if (inliers.size() <= bestInliers.size()) continue;
    best = *plane;
    bestInliers = std::move(inliers);
  }
  if (bestInliers.empty()) return false;
  grow(fit, rest, best, bestInliers);
  if (bestInliers.size() < minOnPlane(fit)) return false;
  for (PlaneTrack* track : rest)
    if (best.error(*track) < kMaxPlaneErrorPx) track->plane = int(planes.size());
  planes.push_back(best);
  return true;
}

}  // namespace ibr
