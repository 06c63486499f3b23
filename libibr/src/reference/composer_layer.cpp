// SPDX-License-Identifier: Apache-2.0
//
// Rasterises triangles in homogeneous coordinates: the vertices' (x w, y w, w) in px are the columns of M, and a = M⁻¹
// (x, y, 1) interpolates: f / w = Σ a_i f_i. A pixel is inside if no a_i is negative; no clipping.
#include "reference/composer_layer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/matrix.hpp>

namespace ibr::reference {
namespace {

constexpr double kMaxJump = 2;           // steps between neighbours of a depth map that form one surface
constexpr double kInsideMargin = -1e-9;  // relative to the weights; avoids gaps between triangles that share an edge

double trustOf(int confirmations) {
  constexpr std::array kTrust{0.06, 0.25, 0.7, 1.0};
  return kTrust[std::size_t(std::clamp(confirmations, 0, 3))];
}

// Pixels that a triangle may cover, both ends inclusive.
struct Box {
  int left, top, right, bottom;
};

Box around(const std::vector<glm::dvec3>& polygon, int width, int height) {
  glm::dvec2 low(width, height), high(-1);
  for (const glm::dvec3& corner : polygon) {
    if (!(corner.z > 0)) return {0, 0, width - 1, height - 1};
    const glm::dvec2 pixel = glm::clamp(glm::dvec2(corner) / corner.z, -1.0, double(std::max(width, height)) + 1);
    low = glm::min(low, pixel);
    high = glm::max(high, pixel);
  }
  return {std::max(0, int(std::floor(low.x)) - 1), std::max(0, int(std::floor(low.y)) - 1),
          std::min(width - 1, int(std::ceil(high.x))), std::min(height - 1, int(std::ceil(high.y)))};
}

Box boxOf(const std::array<glm::dvec3, 3>& corners, int width, int height) {
  std::vector<glm::dvec3> polygon(corners.begin(), corners.end());
  if (std::ranges::all_of(corners, [](const glm::dvec3& c) { return c.z > 0; })) return around(polygon, width, height);
  // A corner is behind the view: clips the triangle to the view's frustum.
  for (const glm::dvec3& plane :
       {glm::dvec3(1, 0, 0), glm::dvec3(0, 1, 0), glm::dvec3(-1, 0, width), glm::dvec3(0, -1, height)}) {
    std::vector<glm::dvec3> inside;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      const glm::dvec3 &from = polygon[i], &to = polygon[(i + 1) % polygon.size()];
      const double start = glm::dot(plane, from), end = glm::dot(plane, to);
      if (start >= 0) inside.push_back(from);
      if ((start < 0) != (end < 0)) inside.push_back(from + start / (start - end) * (to - from));
    }
    polygon = std::move(inside);
  }
  return around(polygon, width, height);
}

}  // namespace

HypothesisMesh hypothesisMesh(const Intrinsics& photograph, const MorphMesh& mesh) {
  HypothesisMesh result;
  for (std::size_t p = 0; p < mesh.vertexCount(); ++p)
    result.vertices.push_back({double(mesh.ratio[0][p]) * unproject(photograph, mesh.match[0][p]),
                               double(mesh.inverseDistance[p]), trustOf(mesh.confirmations[p]),
                               double(mesh.consensus[p])});
  result.triangles.assign(mesh.triangles.begin(), mesh.triangles.begin() + std::ptrdiff_t(mesh.tier0Count()));
  return result;
}

HypothesisMesh hypothesisMesh(const Intrinsics& photograph, const PhotographDepth& depth) {
  HypothesisMesh result;
  const ImageF& map = depth.inverseDepth;
  const Intrinsics k = resized(photograph, map.width, map.height);
  result.vertices.reserve(map.values.size());
  for (int y = 0; y < map.height; ++y)
    for (int x = 0; x < map.width; ++x) {
      const std::size_t at = std::size_t(y) * std::size_t(map.width) + std::size_t(x);
      result.vertices.push_back({{(x + 0.5 - k.cx) / k.fx, (k.cy - y - 0.5) / k.fy, -1.0},
                                 double(map.values[at]),
                                 trustOf(depth.confirmations.values[at]),
                                 double(depth.consensus.values[at])});
    }
  const auto add = [&](const glm::uvec3& corners) {
    double low = double(map.values[corners.x]), high = low;
    for (const std::uint32_t corner : {corners.y, corners.z}) {
      low = std::min(low, double(map.values[corner]));
      high = std::max(high, double(map.values[corner]));
    }
    if (high - low <= kMaxJump * depth.step) result.triangles.push_back(corners);
  };
  for (int y = 0; y + 1 < map.height; ++y)
    for (int x = 0; x + 1 < map.width; ++x) {
      const std::uint32_t at = std::uint32_t(y) * std::uint32_t(map.width) + std::uint32_t(x),
                          below = at + std::uint32_t(map.width);
      add({at, at + 1, below});
      add({at + 1, below + 1, below});
    }
  return result;
}

std::vector<Hypothesis> drawLayer(const Camera& view, const Candidate& candidate, const HypothesisMesh& mesh) {
  const Intrinsics& k = view.intrinsics;
  const glm::dquat toView = glm::conjugate(view.pose.rotation);
  const glm::dmat3 turn = glm::mat3_cast(toView * candidate.camera.pose.rotation);
  const glm::dvec3 shift = toView * (candidate.camera.pose.position - view.pose.position);
  std::vector<glm::dvec3> placed;  // (x w, y w, w) in px
  placed.reserve(mesh.vertices.size());
  for (const HypothesisMesh::Vertex& vertex : mesh.vertices) {
    const glm::dvec3 d = turn * vertex.point + vertex.inverseDepth * shift;
    placed.push_back({k.fx * d.x - k.cx * d.z, -k.fy * d.y - k.cy * d.z, -d.z});
  }
  std::vector<Hypothesis> layer(std::size_t(k.width) * std::size_t(k.height));
  for (const glm::uvec3& triangle : mesh.triangles) {
    const std::array<glm::dvec3, 3> corners{placed[triangle.x], placed[triangle.y], placed[triangle.z]};
    if (std::ranges::all_of(corners, [](const glm::dvec3& c) { return c.z <= 0; })) continue;
    const Box box = boxOf(corners, k.width, k.height);
    if (box.left > box.right || box.top > box.bottom) continue;
    const glm::dmat3 m(corners[0], corners[1], corners[2]);
    if (glm::determinant(m) == 0) continue;  // seen edge-on
    const glm::dmat3 inverse = glm::inverse(m);
    const std::array of{&mesh.vertices[triangle.x], &mesh.vertices[triangle.y], &mesh.vertices[triangle.z]};
    for (int y = box.top; y <= box.bottom; ++y)
      for (int x = box.left; x <= box.right; ++x) {
        const glm::dvec3 a = inverse * glm::dvec3(x + 0.5, y + 0.5, 1.0);
        const double sum = a.x + a.y + a.z;  // 1 / w
        const double least = kInsideMargin * (std::abs(a.x) + std::abs(a.y) + std::abs(a.z));
        if (!(sum > 0 && a.x >= least && a.y >= least && a.z >= least)) continue;
        const auto overW = [&](auto value) { return a.x * value(*of[0]) + a.y * value(*of[1]) + a.z * value(*of[2]); };
        const double inverseDepth =
            std::max(0.0, overW([](const HypothesisMesh::Vertex& v) { return v.inverseDepth; }));
        Hypothesis& here = layer[std::size_t(y) * std::size_t(k.width) + std::size_t(x)];
        if (here.trust > 0 && inverseDepth <= here.inverseDepth) continue;
        here = {inverseDepth, overW([](const HypothesisMesh::Vertex& v) { return v.trust; }) / sum,
                overW([](const HypothesisMesh::Vertex& v) { return v.consensus; }) / sum};
      }
  }
  return layer;
}

}  // namespace ibr::reference
