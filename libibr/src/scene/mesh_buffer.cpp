// SPDX-License-Identifier: Apache-2.0
#include "scene/mesh_buffer.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <glm/geometric.hpp>

#include "base/check.h"

namespace ibr {
namespace {

static_assert(std::endian::native == std::endian::little, "buffers are copied without byte swapping");

double gridOf(int side) {
  return side <= 16384 ? 512.0 : 128.0;
}

template <class T>
void put(std::vector<std::byte>& bytes, MeshLayout::Array array, std::size_t index, const T& value) {
  std::memcpy(&bytes[array.offset + index * sizeof value], &value, sizeof value);
}

template <class T>
T get(std::span<const std::byte> bytes, MeshLayout::Array array, std::size_t index) {
  T value;
  std::memcpy(&value, &bytes[array.offset + index * sizeof value], sizeof value);
  return value;
}

}  // namespace

MeshLayout layoutOf(const MorphMesh& mesh) {
  const std::size_t tier0 = mesh.tier0Count();
  return {mesh.memberCount(),   mesh.vertexCount(),         tier0, mesh.triangles.size() - tier0,
          !mesh.planes.empty(), !mesh.confirmations.empty()};
}

float quantisedMatch(float pixel, int side) {
  return float(std::round(double(pixel) * gridOf(side)) / gridOf(side));
}

float textureCoordinate(float pixel, int side) {
  return float(double(quantisedMatch(pixel, side)) / side);
}

float matchFromTexture(float coordinate, int side) {
  return float(std::round(double(coordinate) * side * gridOf(side)) / gridOf(side));
}

glm::dvec3 displayOrigin(const Scene& scene, const Cell& cell) {
  glm::dvec3 sum(0.0);
  for (const std::uint32_t member : cell.members) sum += scene.nodes[member].camera.pose.position;
  return sum / double(cell.members.size());
}

std::vector<glm::vec3> displayPositions(const Scene& scene, const Cell& cell) {
  const glm::dvec3 origin = displayOrigin(scene, cell);
  double edge = 0;
  for (const std::uint32_t a : cell.members)
    for (const std::uint32_t b : cell.members)
      edge = std::max(edge, glm::distance(scene.nodes[a].camera.pose.position, scene.nodes[b].camera.pose.position));
  const double infinity = 1000.0 * (edge > 0 ? edge : 1.0);
  std::vector<glm::vec3> positions(cell.mesh.vertexCount());
  for (std::size_t p = 0; p < positions.size(); ++p) {
    glm::dvec3 offset(0.0), direction(0.0);
    const double inverseDistance = cell.mesh.inverseDistance[p];
    for (std::size_t i = 0; i < cell.members.size(); ++i) {
      const Camera& camera = scene.nodes[cell.members[i]].camera;
      const glm::dvec3 ray = camera.pose.rotation * unproject(camera.intrinsics, cell.mesh.match[i][p]);
      direction += ray;
      if (inverseDistance > 0)
        offset += camera.pose.position - origin + ray * (double(cell.mesh.ratio[i][p]) / inverseDistance);
    }
    const double length = glm::length(direction);
    offset /= double(cell.members.size());
    if (!(inverseDistance > 0) || glm::length(offset) > infinity)
      offset = length > 0 ? direction * (infinity / length) : glm::dvec3(0.0);
    positions[p] = glm::vec3(offset);
  }
  return positions;
}

std::vector<std::byte> encodeMesh(const Scene& scene, const Cell& cell) {
  const MorphMesh& mesh = cell.mesh;
  const MeshLayout layout = layoutOf(mesh);
  std::vector<std::byte> bytes(layout.bytes());
  Cell stored = cell;
  for (std::size_t i = 0; i < layout.members; ++i) {
    const Intrinsics& k = scene.nodes[cell.members[i]].camera.intrinsics;
    for (std::size_t p = 0; p < layout.points; ++p) {
      const glm::vec2 match = mesh.match[i][p];
      stored.mesh.match[i][p] = {quantisedMatch(match.x, k.width), quantisedMatch(match.y, k.height)};
      put(bytes, layout.textureCoordinates(i), p,
          glm::vec2(textureCoordinate(match.x, k.width), textureCoordinate(match.y, k.height)));
      put(bytes, layout.ratio(), p * layout.members + i, mesh.ratio[i][p]);
    }
  }
  const std::vector<glm::vec3> positions = displayPositions(scene, stored);
  for (std::size_t p = 0; p < layout.points; ++p) {
    put(bytes, layout.inverseDistance(), p, mesh.inverseDistance[p]);
    put(bytes, layout.uncertainty(), p, mesh.uncertainty[p]);
    put(bytes, layout.position(), p, positions[p]);
    if (layout.hasPlanes) put(bytes, layout.planes(), p, mesh.planes[p]);
    if (layout.hasEvidence) {
      put(bytes, layout.confirmations(), p, std::uint32_t(mesh.confirmations[p]));  // includes the padding
      put(bytes, layout.consensus(), p, mesh.consensus[p]);
    }
  }
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const int tier = t < layout.tier0 ? 0 : 1;
    const std::size_t at = t < layout.tier0 ? t : t - layout.tier0;
    put(bytes, layout.ecc(tier), at, mesh.ecc[t]);
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t index = mesh.triangles[t][k];
      if (layout.wideIndices())
        put(bytes, layout.indices(tier), 3 * at + std::size_t(k), index);
      else
        put(bytes, layout.indices(tier), 3 * at + std::size_t(k), std::uint16_t(index));
    }
  }
  return bytes;
}

MorphMesh decodeMesh(std::span<const std::byte> bytes, const MeshLayout& layout, std::span<const glm::ivec2> sizes) {
  constexpr std::size_t kMaxCount = std::size_t(1) << 32;  // prevents overflow of products
  check(layout.members <= 4 && std::max({layout.points, layout.tier0, layout.tier1}) <= kMaxCount,
        ErrorCode::invalidInput, "mesh buffer: {} members, {} points, {} and {} triangles exceed the limits",
        layout.members, layout.points, layout.tier0, layout.tier1);
  check(bytes.size() == layout.bytes() && sizes.size() == layout.members, ErrorCode::invalidInput,
        "mesh buffer: {} bytes, not the {} of {} members, {} points and {} triangles", bytes.size(), layout.bytes(),
        layout.members, layout.points, layout.tier0 + layout.tier1);
  MorphMesh mesh;
  mesh.match.assign(layout.members, std::vector<glm::vec2>(layout.points));
  mesh.ratio.assign(layout.members, std::vector<float>(layout.points));
  for (std::size_t i = 0; i < layout.members; ++i)
    for (std::size_t p = 0; p < layout.points; ++p) {
      const auto at = get<glm::vec2>(bytes, layout.textureCoordinates(i), p);
      mesh.match[i][p] = {matchFromTexture(at.x, sizes[i].x), matchFromTexture(at.y, sizes[i].y)};
      mesh.ratio[i][p] = get<float>(bytes, layout.ratio(), p * layout.members + i);
    }
  for (std::size_t p = 0; p < layout.points; ++p) {
    mesh.inverseDistance.push_back(get<float>(bytes, layout.inverseDistance(), p));
    mesh.uncertainty.push_back(get<float>(bytes, layout.uncertainty(), p));
    if (layout.hasPlanes) mesh.planes.push_back(get<glm::u16vec4>(bytes, layout.planes(), p));
    if (layout.hasEvidence) {
      mesh.confirmations.push_back(std::uint8_t(get<std::uint32_t>(bytes, layout.confirmations(), p)));
      mesh.consensus.push_back(get<float>(bytes, layout.consensus(), p));
    }
  }
  for (int tier = 0; tier < 2; ++tier)
    for (std::size_t t = 0; t < (tier == 0 ? layout.tier0 : layout.tier1); ++t) {
      glm::uvec3 triangle;
      for (int k = 0; k < 3; ++k) {
        const std::size_t at = 3 * t + std::size_t(k);
        triangle[k] = layout.wideIndices() ? get<std::uint32_t>(bytes, layout.indices(tier), at)
                                           : get<std::uint16_t>(bytes, layout.indices(tier), at);
        check(triangle[k] < layout.points, ErrorCode::invalidInput, "mesh buffer: index {} is beyond the {} points",
              triangle[k], layout.points);
      }
      mesh.triangles.push_back(triangle);
      mesh.tier.push_back(std::uint8_t(tier));
      mesh.ecc.push_back(get<float>(bytes, layout.ecc(tier), t));
    }
  return mesh;
}

}  // namespace ibr
