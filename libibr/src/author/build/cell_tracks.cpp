// SPDX-License-Identifier: Apache-2.0
#include "author/build/cell_tracks.h"

#include <algorithm>
#include <glm/gtc/quaternion.hpp>
#include <optional>

namespace ibr {
namespace {

// nullopt at infinity.
std::optional<Track> trackOf(const Scene& scene, const Cell& cell, std::size_t vertex) {
  const MorphMesh& mesh = cell.mesh;
  const double inverseDistance = double(mesh.inverseDistance[vertex]);
  if (!(inverseDistance > 0)) return std::nullopt;
  Track track{glm::dvec3(0), {}};
  for (std::size_t m = 0; m < cell.members.size(); ++m) {
    const Camera& camera = scene.nodes[cell.members[m]].camera;
    const glm::dvec2 pixel(mesh.match[m][vertex]);
    const glm::dvec3 seen = double(mesh.ratio[m][vertex]) * unproject(camera.intrinsics, pixel);
    track.position +=
        (camera.pose.rotation * seen / inverseDistance + camera.pose.position) / double(cell.members.size());
    track.observations.push_back({cell.members[m], pixel});
  }
  return track;
}

}  // namespace

std::vector<Track> cellTracks(const Scene& scene, const std::vector<bool>& hasNone) {
  std::vector<Track> tracks;
  for (const Cell& cell : scene.cells) {
    if (std::ranges::none_of(cell.members, [&](std::uint32_t i) { return hasNone[i]; })) continue;
    std::vector<std::size_t> vertices;
    for (std::size_t t = 0; t < cell.mesh.tier0Count(); ++t)
      for (int c = 0; c < 3; ++c) vertices.push_back(cell.mesh.triangles[t][c]);
    std::ranges::sort(vertices);
    vertices.erase(std::ranges::unique(vertices).begin(), vertices.end());
    const std::size_t apart = std::max<std::size_t>(vertices.size() / kTracksOfCell, 1);
    for (std::size_t k = 0; k < vertices.size(); k += apart)
      if (auto track = trackOf(scene, cell, vertices[k])) tracks.push_back(std::move(*track));
  }
  return tracks;
}

}  // namespace ibr
