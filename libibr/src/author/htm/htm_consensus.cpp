// SPDX-License-Identifier: Apache-2.0
#include "author/htm/htm_consensus.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <glm/geometric.hpp>
#include <glm/mat2x2.hpp>
#include <glm/matrix.hpp>

#include "author/htm/htm_adjacency.h"
#include "author/htm/htm_robust_weight.h"
#include "author/htm/htm_shape.h"
#include "base/check.h"

namespace ibr {
namespace {

glm::dvec3 anyPerpendicular(const glm::dvec3& n) {
  const glm::dvec3 axis = std::abs(n.x) < 0.6 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
  return glm::normalize(glm::cross(n, axis));
}

// px of each image per world unit along two directions of the tangent plane, and the inverses; n_c × n_v each.
class TangentMaps {
 public:
  TangentMaps(const TriangleMesh& mesh, std::span<const HtmView> views) : vertices_(mesh.positions.size()) {
    const std::vector<glm::dvec3> normal = vertexNormals(mesh);
    for (const HtmView& view : views) {
      const PinholeView pinhole(view.camera);
      for (std::size_t v = 0; v < vertices_; ++v) {
        maps_.push_back(mapOf(pinhole, mesh.positions[v], normal[v]));
        inverses_.push_back(glm::inverse(maps_.back()));
      }
    }
  }

  /// J_ij. Precondition: both cameras' maps are usable.
  glm::dmat2 between(std::size_t i, std::size_t j, std::size_t v) const {
    return maps_[i * vertices_ + v] * inverses_[j * vertices_ + v];
  }
  bool usable(std::size_t i, std::size_t v) const { return maps_[i * vertices_ + v] != glm::dmat2(0.0); }

 private:
  static glm::dmat2 mapOf(const PinholeView& view, const glm::dvec3& position, const glm::dvec3& normal) {
    constexpr double kMinCosine = 0.15;  // of the viewing angle; below it the map is unreliable
    const glm::dvec3 towards = view.centre() - position;
    const double distance = glm::length(towards), length = glm::length(normal);
    if (!(length > 0) || !(glm::dot(normal, towards) > kMinCosine * length * distance)) return glm::dmat2(0.0);
    const glm::dvec3 n = normal / length, e = anyPerpendicular(n), f = glm::cross(n, e);
    const double step = 1e-4 * distance;
    const auto here = view.seen(position), alongE = view.seen(position + step * e),
               alongF = view.seen(position + step * f);
    if (!here || !alongE || !alongF) return glm::dmat2(0.0);
    return {(alongE->pixel - here->pixel) / step, (alongF->pixel - here->pixel) / step};
  }

  std::size_t vertices_;
  std::vector<glm::dmat2> maps_, inverses_;
};

// Normal equations, sums of wᵀ W w: a symmetric matrix and a right-hand side.
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

// A match as a constraint: b_i = displacement + map b_j.
struct Claim {
  glm::dmat2 map;  // J_ij
  glm::vec2 displacement;
  glm::vec3 information;
  double strength;  // maxInformation(information)
};

// Another camera of the vertex: indices of its claim on the offset, and of the offset's claim on that camera's own.
struct Partner {
  static constexpr std::uint32_t kNone = ~std::uint32_t(0);
  std::uint32_t camera, into = kNone, from = kNone;
};

class Consensus {
 public:
  Consensus(const TriangleMesh& mesh, std::span<const HtmView> views, std::span<const CameraSet> members,
            std::span<const VertexMatch> matches, const ConsensusOptions& options)
      : neighbours_(neighboursOfVertices(mesh)),
        members_(members),
        options_(options),
        cameras_(views.size()),
        vertices_(mesh.positions.size()),
        offsets_(cameras_ * vertices_, glm::dvec2(0.0)) {
    const TangentMaps maps(mesh, views);
    for (std::size_t v = 0; v < vertices_; ++v) addPartners(v, maps, matches);
  }

  std::vector<glm::vec2> solve(const ProgressCallback& progress) {
    const auto sweeps = std::size_t(std::max(0, options_.sweeps));
    for (std::size_t sweep = 0; sweep < sweeps; ++sweep) {
      check(!progress || progress({"adjusting cameras", sweep, sweeps}), ErrorCode::cancelled,
            "cancelled while adjusting cameras");
      for (std::size_t k = 0; k < vertices_; ++k) {
        const std::size_t v = sweep % 2 == 0 ? k : vertices_ - 1 - k;
        for (std::size_t i = 0; i < cameras_; ++i)
          if (members_[v] >> i & 1) update(i, v, sweep >= sweeps / 4);
      }
    }
    return {offsets_.begin(), offsets_.end()};
  }

 private:
  std::size_t at(std::size_t i, std::size_t v) const { return i * vertices_ + v; }

  void addPartners(std::size_t v, const TangentMaps& maps, std::span<const VertexMatch> matches) {
    const auto counts = [&](std::size_t i) { return (members_[v] >> i & 1) && maps.usable(i, v); };
    claimAt_.assign(cameras_ * cameras_, Partner::kNone);
    for (std::size_t i = 0; i < cameras_; ++i)
      for (std::size_t j = 0; j < cameras_; ++j) {
        const VertexMatch& match = matches[(i * cameras_ + j) * vertices_ + v];
        if (i == j || !counts(i) || !counts(j) || match.information == glm::vec3(0.0f)) continue;
        claimAt_[i * cameras_ + j] = std::uint32_t(claims_.size());
        claims_.push_back(
            {maps.between(i, j, v), match.displacement, match.information, maxInformation(match.information)});
      }
    for (std::size_t i = 0; i < cameras_; ++i) {
      for (std::size_t j = 0; j < cameras_; ++j) {
        const std::uint32_t into = claimAt_[i * cameras_ + j], from = claimAt_[j * cameras_ + i];
        if (into != Partner::kNone || from != Partner::kNone) partners_.push_back({std::uint32_t(j), into, from});
      }
      firstPartner_.push_back(partners_.size());
    }
  }

  std::span<const Partner> partnersOf(std::size_t i, std::size_t v) const {
    const std::size_t list = v * cameras_ + i;
    return std::span(partners_).subspan(firstPartner_[list], firstPartner_[list + 1] - firstPartner_[list]);
  }

  void update(std::size_t i, std::size_t v, bool doubted) {
    Normal2 sum;
    const double prior = 1 / (options_.offsetPx * options_.offsetPx);
    sum.add(glm::dmat2(prior), glm::dvec2(0.0));
    for (const std::uint32_t u : neighbours_[v])
      if (members_[u] >> i & 1) sum.add(glm::dmat2(options_.smoothness), offsets_[at(i, u)]);
    const glm::dvec2 now = offsets_[at(i, v)];
    const auto weightOf = [&](const Claim& claim, const glm::dvec2& residual) {
      return matrixOf(claim.information) *
             (doubted ? robustWeight(claim.information, claim.strength, residual, options_.outlierPx) : 1.0);
    };
    for (const Partner& partner : partnersOf(i, v)) {
      const glm::dvec2 other = offsets_[at(partner.camera, v)];
      if (partner.into != Partner::kNone) {
        const Claim& into = claims_[partner.into];
        const glm::dvec2 wanted = glm::dvec2(into.displacement) + into.map * other;
        sum.add(weightOf(into, now - wanted), wanted);
      }
      if (partner.from != Partner::kNone) {
        // From b_j = c + J b_i follows b_i = J⁻¹ (b_j − c), with weight Jᵀ W J.
        const Claim& from = claims_[partner.from];
        const glm::dvec2 target = other - glm::dvec2(from.displacement);
        const glm::dmat2 weight = weightOf(from, target - from.map * now);
        sum.matrix += glm::transpose(from.map) * weight * from.map;
        sum.side += glm::transpose(from.map) * (weight * target);
      }
    }
    if (glm::determinant(sum.matrix) > 1e-12) offsets_[at(i, v)] = glm::inverse(sum.matrix) * sum.side;
  }

  std::vector<Claim> claims_;
  std::vector<Partner> partners_;             // lists, one for each camera of each vertex
  std::vector<std::size_t> firstPartner_{0};  // offsets of the lists, and one more
  std::vector<std::uint32_t> claimAt_;        // of each vertex: n_c × n_c indices
  Lists neighbours_;
  std::span<const CameraSet> members_;
  const ConsensusOptions& options_;
  std::size_t cameras_, vertices_;
  std::vector<glm::dvec2> offsets_;
};

}  // namespace

std::vector<glm::vec2> consensusOffsets(const TriangleMesh& mesh, std::span<const HtmView> views,
                                        std::span<const CameraSet> members, std::span<const VertexMatch> matches,
                                        const ConsensusOptions& options, const ProgressCallback& progress) {
  return Consensus(mesh, views, members, matches, options).solve(progress);
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
