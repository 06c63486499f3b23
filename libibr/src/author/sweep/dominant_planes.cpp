// SPDX-License-Identifier: Apache-2.0
#include "author/sweep/dominant_planes.h"

#include <algorithm>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "author/sweep/homographies.h"
#include "author/sweep/plane_maps.h"

namespace ibr {
namespace {

constexpr std::size_t kMaxDominantPlanes = 3;
constexpr double kMinShare = 0.2;       // of the points; with less, chance fits planes through trees
constexpr std::size_t kNeighbours = 8;  // neighbours of a track, most of which must lie on its plane
constexpr std::uint64_t kSeed = 1;

// Projects the points into the frame and the members; keeps those in front of all of them and inside the frame's image.
std::vector<PlaneTrack> tracksOf(std::span<const Camera> cameras, std::span<const glm::dvec3> points) {
  std::vector<PlaneTrack> tracks;
  for (const glm::dvec3& point : points) {
    PlaneTrack track;
    bool seen = true;
    for (std::size_t i = 0; i < cameras.size() && seen; ++i) {
      const Camera& camera = cameras[i];
      const auto pixel =
          project(camera.intrinsics, glm::inverse(camera.pose.rotation) * (point - camera.pose.position));
      seen = pixel && (i > 0 || (pixel->x >= 0 && pixel->y >= 0 && pixel->x < camera.intrinsics.width &&
                                 pixel->y < camera.intrinsics.height));
      if (seen) track.at[i] = *pixel;
    }
    if (seen) tracks.push_back(track);
  }
  return tracks;
}

// True if most of the nearest tracks were found on the same plane.
bool hasPlaneNeighbours(const PlaneTrack& track, std::span<const PlaneTrack> tracks) {
  std::vector<std::pair<double, int>> near;  // squared distance in the frame's image, plane
  for (const PlaneTrack& other : tracks) {
    const glm::dvec2 off = other.at[0] - track.at[0];
    near.emplace_back(glm::dot(off, off), other.plane);
  }
  const auto end = near.begin() + std::ptrdiff_t(std::min(kNeighbours + 1, near.size()));
  std::partial_sort(near.begin(), end, near.end());
  const auto own = std::count_if(near.begin() + 1, end, [&](const auto& n) { return n.second == track.plane; });
  return 2 * own > end - near.begin() - 1;
}

// Share of the tracks that lie on the plane together with most of their neighbours. A visible plane has such tracks; a
// chance plane through trees and houses, or across the ground, has other tracks in between.
double support(std::span<const PlaneTrack> tracks, int plane) {
  const auto held = [&](const PlaneTrack& track) { return track.plane == plane && hasPlaneNeighbours(track, tracks); };
  return double(std::ranges::count_if(tracks, held)) / double(tracks.size());
}

}  // namespace

std::vector<glm::dvec3> dominantPlanes(const Camera& frame, std::span<const Camera> members,
                                       std::span<const glm::dvec3> points) {
  std::vector<Camera> cameras{frame};
  for (const Camera& member : members.first(std::min(members.size(), kMaxMembers - 1))) cameras.push_back(member);
  std::vector<PlaneTrack> tracks = tracksOf(cameras, points);
  const PlaneFitter fit(cameras, true);
  std::vector<FrameToMember> maps;
  for (const Camera& camera : cameras) maps.push_back(frameToMember(frame, camera));
  // The member with the largest parallax determines the plane best: its homography is a + b·nᵀ.
  const auto farthest = std::ranges::max_element(maps, {}, [](const FrameToMember& m) { return glm::dot(m.b, m.b); });

  std::vector<PlaneMaps> found;
  std::vector<glm::dvec3> planes;
  while (found.size() < kMaxDominantPlanes && sealLargestPlane(fit, tracks, found, kSeed)) {
    if (support(tracks, int(found.size()) - 1) < kMinShare) continue;
    const glm::dmat3 slanted = found.back().to[std::size_t(farthest - maps.begin())] - farthest->a;
    planes.push_back(glm::transpose(slanted) * farthest->b / glm::dot(farthest->b, farthest->b));
  }
  return planes;
}

}  // namespace ibr
