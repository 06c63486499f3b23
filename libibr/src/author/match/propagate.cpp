// SPDX-License-Identifier: Apache-2.0
#include "author/match/propagate.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <unordered_map>

#include "author/match/track_mesh.h"
#include "author/sweep/homographies.h"

namespace ibr {
namespace {

constexpr double kMinCorrelationGain = 0.02;         // minimum gain of correlation for a match to change its plane
constexpr double kMinExtrapolatedCorrelation = 0.8;  // minimum correlation of extrapolated matches …
constexpr double kMinFocusedCorrelation = 0.8;       // … and of matches found by descriptor
constexpr double kMaxAlignmentPx = 1.5;              // maximum alignment of a new match, px
constexpr double kMinSpacingPx = 3.0;                // minimum distance between matches, px
constexpr double kMarginPx = 4.0;                    // around the corresponding triangle, px
constexpr int kMaxDescriptorDistance = 100'000;      // maximum distance (0.38 of unit descriptors, squared)
constexpr double kMaxDescriptorRatio = 0.8;
constexpr double kMaxPlaneDistancePx = 40.0;  // maximum distance of a feature from matches whose planes are tried, px …
constexpr std::size_t kNeighbours = 8;        // … at most so many of them
constexpr double kMaxStretch = 2.0;           // maximum growth of distances between members

// Features in a spatial grid, for lookup of neighbours.
class Buckets {
 public:
  explicit Buckets(double side) : side_(side) {}
  void add(glm::dvec2 at, std::uint32_t id) { cells_[key(cell(at))].emplace_back(at, id); }
  template <class Visit>
  void forWithin(glm::dvec2 low, glm::dvec2 high, Visit&& visit) const {
    const glm::ivec2 a = cell(low), b = cell(high);
    for (int y = a.y; y <= b.y; ++y)
      for (int x = a.x; x <= b.x; ++x)
        if (const auto found = cells_.find(key({x, y})); found != cells_.end())
          for (const auto& [at, id] : found->second)
            if (at.x >= low.x && at.y >= low.y && at.x <= high.x && at.y <= high.y) visit(at, id);
  }
  bool anyWithin(glm::dvec2 at, double distance) const {
    bool any = false;
    forWithin(at - distance, at + distance,
              [&](glm::dvec2 other, std::uint32_t) { any = any || glm::distance(at, other) < distance; });
    return any;
  }

 private:
  glm::ivec2 cell(glm::dvec2 at) const { return glm::ivec2(glm::floor(at / side_)); }
  static std::uint64_t key(glm::ivec2 c) { return (std::uint64_t(std::uint32_t(c.x)) << 32) | std::uint32_t(c.y); }
  double side_;
  std::unordered_map<std::uint64_t, std::vector<std::pair<glm::dvec2, std::uint32_t>>> cells_;
};

bool contains(const std::array<glm::dvec2, 3>& corner, glm::dvec2 p) {
  const auto side = [&](int k) {
    const glm::dvec2 u = corner[std::size_t(k + 1) % 3] - corner[std::size_t(k)], v = p - corner[std::size_t(k)];
    return u.x * v.y - u.y * v.x;
  };
  return side(0) >= 0 && side(1) >= 0 && side(2) >= 0;
}

// Returns the planes of a triangle's corners, each once.
std::vector<int> planesOf(const std::vector<PlaneTrack>& tracks, const glm::uvec3& t) {
  std::vector<int> planes;
  for (int k = 0; k < 3; ++k)
    if (const int plane = tracks[t[k]].plane; plane >= 0) planes.push_back(plane);
  std::ranges::sort(planes);
  planes.erase(std::ranges::unique(planes).begin(), planes.end());
  return planes;
}

struct Box {
  glm::dvec2 low, high;
};
Box boxOf(const std::vector<PlaneTrack>& tracks, const glm::uvec3& t, std::size_t member) {
  const glm::dvec2 a = tracks[t.x].at[member], b = tracks[t.y].at[member], c = tracks[t.z].at[member];
  return {glm::min(a, glm::min(b, c)) - kMarginPx, glm::max(a, glm::max(b, c)) + kMarginPx};
}

// Calls `attempt(triangle, feature, at)` for the first member's features without a track, inside their triangles.
// `attempt` returns a new track, or nothing.
template <class Attempt>
std::size_t forUnmatched(std::vector<PlaneTrack>& tracks, const Features& first, Attempt&& attempt) {
  const std::vector<glm::uvec3> triangles = trackTriangles(tracks);
  Buckets matched(8), free(8);
  std::vector<bool> taken(first.count(), false);
  for (const PlaneTrack& track : tracks) {
    matched.add(track.at[0], 0);
    if (track.feature[0] != kNoFeature) taken[track.feature[0]] = true;
  }
  for (std::uint32_t f = 0; f < first.count(); ++f)
    if (!taken[f]) free.add(first.at[f], f);
  std::size_t added = 0;
  for (const glm::uvec3& t : triangles) {
    const std::array<glm::dvec2, 3> corner{tracks[t.x].at[0], tracks[t.y].at[0], tracks[t.z].at[0]};
    const glm::dvec2 low = glm::min(corner[0], glm::min(corner[1], corner[2]));
    const glm::dvec2 high = glm::max(corner[0], glm::max(corner[1], corner[2]));
    std::vector<std::pair<std::uint32_t, glm::dvec2>> inside;
    free.forWithin(low, high, [&](glm::dvec2 at, std::uint32_t f) {
      if (!taken[f] && contains(corner, at)) inside.emplace_back(f, at);
    });
    std::ranges::sort(inside, {}, &std::pair<std::uint32_t, glm::dvec2>::first);
    for (const auto& [f, at] : inside) {
      if (matched.anyWithin(at, kMinSpacingPx)) continue;
      std::optional<PlaneTrack> track = attempt(t, f, at);
      if (!track) continue;
      taken[f] = true;
      matched.add(at, 0);
      tracks.push_back(*track);
      ++added;
    }
  }
  return added;
}

}  // namespace

void refineLocally(std::vector<PlaneTrack>& tracks, const Propagation& with) {
  const std::size_t d = with.features.size();
  const auto neighbours = trackNeighbours(tracks.size(), trackTriangles(tracks));
  std::vector<PlaneTrack> refined = tracks;
  for (std::size_t t = 0; t < tracks.size(); ++t) {
    PlaneTrack& track = refined[t];
    if (track.plane < 0) continue;
    std::vector<int> planes;
    std::array<double, kMaxMembers> reach{};
    for (const std::uint32_t n : neighbours[t]) {
      if (tracks[n].plane >= 0 && tracks[n].plane != track.plane) planes.push_back(tracks[n].plane);
      for (std::size_t i = 0; i < d; ++i)
        reach[i] = std::max(reach[i], glm::distance(tracks[n].at[i], tracks[t].at[i]));
    }
    std::ranges::sort(planes);
    planes.erase(std::ranges::unique(planes).begin(), planes.end());
    double best =
        with.patches.correlation(with.planes[std::size_t(track.plane)], {track.at.data(), d}) + kMinCorrelationGain;
    for (const int p : planes) {
      const PlaneMaps& plane = with.planes[std::size_t(p)];
      const auto at = plane(tracks[t].at[0]);
      if (!at) continue;
      bool near = true;
      for (std::size_t i = 0; i < d; ++i) near = near && glm::distance((*at)[i], tracks[t].at[i]) <= reach[i];
      if (!near) continue;
      const double found = with.patches.correlation(plane, {at->data(), d});
      if (found <= best) continue;
      best = found;
      track.at = *at;
      track.plane = p;
      for (std::size_t i = 1; i < d; ++i) track.feature[i] = kNoFeature;
    }
  }
  tracks = std::move(refined);
}

std::size_t extrapolateLocally(std::vector<PlaneTrack>& tracks, const Propagation& with) {
  const std::size_t d = with.features.size();
  const Features& first = with.features[0];
  Buckets matched(kMaxPlaneDistancePx / 2);
  std::vector<bool> taken(first.count(), false);
  for (std::size_t t = 0; t < tracks.size(); ++t) {
    matched.add(tracks[t].at[0], std::uint32_t(t));
    if (tracks[t].feature[0] != kNoFeature) taken[tracks[t].feature[0]] = true;
  }
  const std::size_t before = tracks.size();
  std::vector<std::pair<double, std::uint32_t>> around;
  std::vector<PlaneTrack> found;
  Buckets added(kMinSpacingPx);
  for (std::uint32_t f = 0; f < first.count(); ++f) {
    const glm::dvec2 pixel(first.at[f]);
    if (taken[f] || added.anyWithin(pixel, kMinSpacingPx)) continue;
    around.clear();
    matched.forWithin(pixel - kMaxPlaneDistancePx, pixel + kMaxPlaneDistancePx,
                      [&](glm::dvec2 at, std::uint32_t t) { around.emplace_back(glm::distance(at, pixel), t); });
    std::ranges::sort(around);
    if (around.empty() || around[0].first < kMinSpacingPx) continue;
    if (around.size() > kNeighbours) around.resize(kNeighbours);
    std::vector<int> planes;
    for (const auto& [distance, t] : around)
      if (tracks[t].plane >= 0) planes.push_back(tracks[t].plane);
    std::ranges::sort(planes);
    planes.erase(std::ranges::unique(planes).begin(), planes.end());
    PlaneTrack track;
    double best = kMinExtrapolatedCorrelation;
    for (const int p : planes) {
      const PlaneMaps& plane = with.planes[std::size_t(p)];
      auto at = plane(pixel);
      if (!at) continue;
      // In each member, the distance to the neighbours' matches may grow only by kMaxStretch.
      bool near = true;
      for (std::size_t i = 1; i < d; ++i) {
        double least = std::numeric_limits<double>::infinity();
        for (const auto& [distance, t] : around)
          least = std::min(least, glm::distance((*at)[i], tracks[t].at[i]) - kMaxStretch * distance);
        near = near && least < kMarginPx;
      }
      if (!near) continue;
      const double correlation = with.patches.align(plane, {at->data(), d}, kMaxAlignmentPx);
      if (correlation <= best) continue;
      best = correlation;
      track.at = *at;
      track.plane = p;
    }
    if (track.plane < 0) continue;
    track.feature[0] = f;
    found.push_back(track);
    added.add(pixel, f);
  }
  tracks.insert(tracks.end(), found.begin(), found.end());
  return tracks.size() - before;
}

std::size_t matchFocused(std::vector<PlaneTrack>& tracks, const Propagation& with) {
  const std::size_t d = with.features.size();
  std::vector<Buckets> free(d, Buckets(16));
  std::vector<std::vector<bool>> taken;
  for (std::size_t i = 0; i < d; ++i) {
    taken.emplace_back(with.features[i].count(), false);
    for (const PlaneTrack& track : tracks)
      if (track.feature[i] != kNoFeature) taken[i][track.feature[i]] = true;
    for (std::uint32_t f = 0; f < with.features[i].count(); ++f)
      if (!taken[i][f]) free[i].add(with.features[i].at[f], f);
  }
  return forUnmatched(
      tracks, with.features[0],
      [&](const glm::uvec3& t, std::uint32_t f, glm::dvec2 pixel) -> std::optional<PlaneTrack> {
        PlaneTrack track;
        track.at[0] = pixel;
        track.feature[0] = f;
        for (std::size_t i = 1; i < d; ++i) {
          int best = kMaxDescriptorDistance, second = 2 * kMaxDescriptorDistance;
          const Box box = boxOf(tracks, t, i);
          free[i].forWithin(box.low, box.high, [&](glm::dvec2 at, std::uint32_t g) {
            if (taken[i][g]) return;
            const int distance = descriptorDistance(with.features[0], f, with.features[i], g);
            if (distance < best) {
              second = std::min(second, best);
              best = distance;
              track.feature[i] = g;
              track.at[i] = at;
            } else {
              second = std::min(second, distance);
            }
          });
          if (track.feature[i] == kNoFeature || best > kMaxDescriptorRatio * kMaxDescriptorRatio * second)
            return std::nullopt;
        }
        // The corners' planes only give the compared windows their slant.
        double best = kMinFocusedCorrelation;
        std::optional<PlaneTrack> found;
        for (const int p : planesOf(tracks, t)) {
          const PlaneMaps& plane = with.planes[std::size_t(p)];
          PlaneTrack tried = track;
          const double correlation = with.patches.align(plane, {tried.at.data(), d}, kMaxAlignmentPx);
          if (correlation <= best) continue;
          best = correlation;
          tried.plane = plane.error(tried) < kMaxPlaneErrorPx ? p : -1;
          found = tried;
        }
        if (found)
          for (std::size_t i = 1; i < d; ++i) taken[i][found->feature[i]] = true;
        return found;
      });
}

}  // namespace ibr
