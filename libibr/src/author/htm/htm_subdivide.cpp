// SPDX-License-Identifier: Apache-2.0
#include "author/htm/htm_subdivide.h"

#include <algorithm>
#include <glm/geometric.hpp>
#include <unordered_map>

#include "base/check.h"

namespace ibr {
namespace {

constexpr std::uint32_t kNone = ~0u;

std::uint64_t edgeKey(std::uint32_t a, std::uint32_t b) {
  return std::uint64_t(std::min(a, b)) << 32 | std::max(a, b);
}

double squaredDistance(const TriangleMesh& mesh, std::uint32_t a, std::uint32_t b) {
  const glm::dvec3 between = mesh.positions[b] - mesh.positions[a];
  return glm::dot(between, between);
}

// `middle`: midpoint of the edge from corner k to the next; kNone if the edge is not divided.
void divide(const TriangleMesh& mesh, glm::uvec3 corner, glm::uvec3 middle, std::vector<glm::uvec3>& faces) {
  const int count = (middle.x != kNone) + (middle.y != kNone) + (middle.z != kNone);
  // Rotate the corners so that divided edges come first: one, or two adjacent ones.
  const auto turn = [&] {
    corner = {corner.y, corner.z, corner.x};
    middle = {middle.y, middle.z, middle.x};
  };
  switch (count) {
    case 0:
      faces.push_back(corner);
      return;
    case 1:
      while (middle.x == kNone) turn();
      faces.emplace_back(corner.x, middle.x, corner.z);
      faces.emplace_back(middle.x, corner.y, corner.z);
      return;
    case 2: {
      while (middle.z != kNone) turn();
      faces.emplace_back(middle.x, corner.y, middle.y);
      const double fromFirst = squaredDistance(mesh, corner.x, middle.y),
                   fromLast = squaredDistance(mesh, middle.x, corner.z);
      if (fromFirst < fromLast || (fromFirst == fromLast && corner.x < corner.z)) {
        faces.emplace_back(corner.x, middle.x, middle.y);
        faces.emplace_back(corner.x, middle.y, corner.z);
      } else {
        faces.emplace_back(corner.x, middle.x, corner.z);
        faces.emplace_back(middle.x, middle.y, corner.z);
      }
      return;
    }
    default:
      faces.emplace_back(corner.x, middle.x, middle.z);
      faces.emplace_back(middle.x, corner.y, middle.y);
      faces.emplace_back(middle.z, middle.y, corner.z);
      faces.emplace_back(middle.x, middle.y, middle.z);
  }
}

}  // namespace

SubdividedMesh subdivideFaces(const TriangleMesh& mesh, std::span<const std::uint8_t> chosen) {
  check(chosen.size() == mesh.triangles.size(), ErrorCode::invalidInput, "subdivideFaces: {} choices for {} faces",
        chosen.size(), mesh.triangles.size());
  SubdividedMesh result{mesh, {}, {}};
  std::unordered_map<std::uint64_t, std::uint32_t> middles;
  for (std::size_t f = 0; f < chosen.size(); ++f) {
    const glm::uvec3& t = mesh.triangles[f];
    check(std::max({t.x, t.y, t.z}) < mesh.positions.size(), ErrorCode::invalidInput,
          "subdivideFaces: face {} has a corner beyond the {} vertices", f, mesh.positions.size());
    if (!chosen[f]) continue;
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t a = t[k], b = t[(k + 1) % 3];
      check(result.mesh.positions.size() < kNone, ErrorCode::invalidInput, "subdivideFaces: too many vertices");
      if (!middles.emplace(edgeKey(a, b), std::uint32_t(result.mesh.positions.size())).second) continue;
      result.mesh.positions.push_back(0.5 * (mesh.positions[a] + mesh.positions[b]));
      result.parents.emplace_back(std::min(a, b), std::max(a, b));
    }
  }
  result.mesh.triangles.clear();
  for (std::uint32_t f = 0; f < chosen.size(); ++f) {
    const glm::uvec3& t = mesh.triangles[f];
    glm::uvec3 middle;
    for (int k = 0; k < 3; ++k) {
      const auto found = middles.find(edgeKey(t[k], t[(k + 1) % 3]));
      middle[k] = found == middles.end() ? kNone : found->second;
    }
    divide(result.mesh, t, middle, result.mesh.triangles);
    result.faceOf.resize(result.mesh.triangles.size(), f);
  }
  return result;
}

std::vector<glm::vec2> dividedComplements(std::span<const glm::vec2> complements, std::size_t cameras,
                                          std::size_t before, std::span<const glm::uvec2> parents) {
  if (complements.empty()) return {};
  const std::size_t after = before + parents.size();
  std::vector<glm::vec2> divided;
  divided.reserve(cameras * cameras * after);
  for (std::size_t pair = 0; pair < cameras * cameras; ++pair) {
    const auto old = complements.subspan(pair * before, before);
    divided.insert(divided.end(), old.begin(), old.end());
    for (const glm::uvec2 ends : parents) divided.push_back(0.5f * (old[ends.x] + old[ends.y]));
  }
  return divided;
}

}  // namespace ibr
