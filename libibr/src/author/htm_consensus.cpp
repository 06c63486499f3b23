// SPDX-License-Identifier: Apache-2.0
#include "author/htm_consensus.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/mat2x2.hpp>
#include <glm/matrix.hpp>

#include "author/htm_adjacency.h"
#include "author/htm_shape.h"
#include "author/htm_trust.h"

namespace ibr {
namespace {

glm::dvec3 anyAcross(const glm::dvec3& n) {
  const glm::dvec3 axis = std::abs(n.x) < 0.6 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
  return glm::normalize(glm::cross(n, axis));
}

// px of each picture per world unit along two directions of the tangent plane; one n_c × n_v.
class TangentMaps {
 public:
  TangentMaps(const TriangleMesh& mesh, std::span<const HtmView> views) : vertices_(mesh.positions.size()) {
    const std::vector<glm::dvec3> normal = vertexNormals(mesh);
    for (const HtmView& view : views) {
      const PinholeView pinhole(view.camera);
      for (std::size_t v = 0; v < vertices_; ++v) maps_.push_back(mapOf(pinhole, mesh.positions[v], normal[v]));
    }
  }

  /// J_ij; only where both are usable.
  glm::dmat2 between(std::size_t i, std::size_t j, std::size_t v) const {
    return maps_[i * vertices_ + v] * glm::inverse(maps_[j * vertices_ + v]);
  }
  bool usable(std::size_t i, std::size_t v) const { return maps_[i * vertices_ + v] != glm::dmat2(0.0); }

 private:
  static glm::dmat2 mapOf(const PinholeView& view, const glm::dvec3& position, const glm::dvec3& normal) {
    constexpr double kLeastCosine = 0.15;  // flatter, and the map is no guide
    const glm::dvec3 towards = view.centre() - position;
    const double distance = glm::length(towards), length = glm::length(normal);
    if (!(length > 0) || !(glm::dot(normal, towards) > kLeastCosine * length * distance)) return glm::dmat2(0.0);
    const glm::dvec3 n = normal / length, e = anyAcross(n), f = glm::cross(n, e);
    const double step = 1e-4 * distance;
    const auto here = view.seen(position), alongE = view.seen(position + step * e), alongF = view.seen(position + step * f);
    if (!here || !alongE || !alongF) return glm::dmat2(0.0);
    return {(alongE->pixel - here->pixel) / step, (alongF->pixel - here->pixel) / step};
  }

  std::size_t vertices_;
  std::vector<glm::dmat2> maps_;
};

// Sums of wᵀ W w: a symmetric matrix and a right-hand side.
struct Normal2 {
  glm::dmat2 matrix{0.0};
  glm::dvec2 side{0.0};
  void add(const glm::dmat2& weight, const glm::dvec2& wanted) {
    matrix += weight;
    side += weight * wanted;
  }
};

glm::dmat2 matrixOf(const glm::vec3& information) {
  return {{information.x, information.y}, {information.y, information.z}};
}

class Consensus {
 public:
  Consensus(const TriangleMesh& mesh, std::span<const HtmView> views, std::span<const CameraSet> members,
            std::span<const VertexMatch> matches, const ConsensusOptions& options)
      : maps_(mesh, views),
        neighbours_(neighboursOfVertices(mesh)),
        members_(members),
        matches_(matches),
        options_(options),
        cameras_(views.size()),
        vertices_(mesh.positions.size()),
        offsets_(cameras_ * vertices_, glm::dvec2(0.0)) {}

  std::vector<glm::vec2> solve() {
    for (int sweep = 0; sweep < options_.sweeps; ++sweep)
      for (std::size_t k = 0; k < vertices_; ++k) {
        const std::size_t v = sweep % 2 == 0 ? k : vertices_ - 1 - k;
        for (std::size_t i = 0; i < cameras_; ++i)
          if (members_[v] >> i & 1) update(i, v, sweep >= options_.sweeps / 4);
      }
    return {offsets_.begin(), offsets_.end()};
  }

 private:
  std::size_t at(std::size_t i, std::size_t v) const { return i * vertices_ + v; }

  void update(std::size_t i, std::size_t v, bool doubted) {
    Normal2 sum;
    const double prior = 1 / (options_.offsetPx * options_.offsetPx);
    sum.add(glm::dmat2(prior), glm::dvec2(0.0));
    for (const std::uint32_t u : neighbours_[v])
      if (members_[u] >> i & 1) sum.add(glm::dmat2(options_.smoothness), offsets_[at(i, u)]);
    const glm::dvec2 now = offsets_[at(i, v)];
    if (maps_.usable(i, v))
      for (std::size_t j = 0; j < cameras_; ++j) {
        if (j == i || !(members_[v] >> j & 1) || !maps_.usable(j, v)) continue;
        const VertexMatch &into = matches_[(i * cameras_ + j) * vertices_ + v],
                          &from = matches_[(j * cameras_ + i) * vertices_ + v];
        if (into.information != glm::vec3(0.0f)) {
          const glm::dvec2 wanted = glm::dvec2(into.displacement) + maps_.between(i, j, v) * offsets_[at(j, v)];
          const double trust = doubted ? trustOf(into.information, now - wanted, options_.outlierPx) : 1.0;
          sum.add(matrixOf(into.information) * trust, wanted);
        }
        if (from.information != glm::vec3(0.0f)) {
          // b_j = c + J b_i: b_i = J⁻¹ (b_j − c), weighed by Jᵀ W J.
          const glm::dmat2 j2 = maps_.between(j, i, v);
          const glm::dvec2 target = offsets_[at(j, v)] - glm::dvec2(from.displacement);
          const double trust = doubted ? trustOf(from.information, target - j2 * now, options_.outlierPx) : 1.0;
          const glm::dmat2 weight = matrixOf(from.information) * trust;
          sum.matrix += glm::transpose(j2) * weight * j2;
          sum.side += glm::transpose(j2) * (weight * target);
        }
      }
    if (glm::determinant(sum.matrix) > 1e-12) offsets_[at(i, v)] = glm::inverse(sum.matrix) * sum.side;
  }

  TangentMaps maps_;
  Lists neighbours_;
  std::span<const CameraSet> members_;
  std::span<const VertexMatch> matches_;
  const ConsensusOptions& options_;
  std::size_t cameras_, vertices_;
  std::vector<glm::dvec2> offsets_;
};

}  // namespace

std::vector<glm::vec2> consensusOffsets(const TriangleMesh& mesh, std::span<const HtmView> views,
                                        std::span<const CameraSet> members, std::span<const VertexMatch> matches,
                                        const ConsensusOptions& options) {
  return Consensus(mesh, views, members, matches, options).solve();
}

std::vector<glm::vec2> consistentComplements(const TriangleMesh& mesh, std::span<const HtmView> views,
                                             std::span<const CameraSet> members, std::span<const glm::vec2> offsets) {
  const std::size_t n = mesh.positions.size(), cameras = views.size();
  const TangentMaps maps(mesh, views);
  std::vector<glm::vec2> complements(cameras * cameras * n, glm::vec2(0.0f));
  for (std::size_t i = 0; i < cameras; ++i)
    for (std::size_t j = 0; j < cameras; ++j)
      for (std::size_t v = 0; v < n; ++v) {
        const CameraSet pair = CameraSet(1) << i | CameraSet(1) << j;
        if (i == j || (members[v] & pair) != pair) continue;
        const glm::vec2 own = offsets[i * n + v];
        const bool both = maps.usable(i, v) && maps.usable(j, v);
        complements[(i * cameras + j) * n + v] =
            both ? own - glm::vec2(maps.between(i, j, v) * glm::dvec2(offsets[j * n + v])) : glm::vec2(0.0f);
      }
  return complements;
}

}  // namespace ibr
