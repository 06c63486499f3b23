// SPDX-License-Identifier: Apache-2.0
#include "author/htm/htm_complements.h"

#include <algorithm>
#include <glm/geometric.hpp>

#include "author/htm/htm_adjacency.h"
#include "author/htm/htm_robust_weight.h"
#include "base/parallel.h"

namespace ibr {
namespace {

// Minimises Σ w (c − m)ᵀ W (c − m) + smoothness Σ |c_u − c_v|² over edges + Σ |c|² / complementPx² for one pair by
// Gauss-Seidel. The weight w falls as the match m departs from the complements around it.
class PairField {
 public:
  PairField(const Lists& neighbours, std::span<const CameraSet> members, CameraSet pair,
            std::span<const VertexMatch> matches, const ComplementOptions& options)
      : neighbours_(neighbours), members_(members), pair_(pair), matches_(matches), options_(options) {}

  void solve(std::span<glm::vec2> complements) const {
    for (std::size_t v = 0; v < members_.size(); ++v)
      complements[v] = inPair(v) ? matches_[v].displacement : glm::vec2(0.0f);
    if (!(options_.smoothness > 0)) return;
    constexpr int kSweeps = 80;
    for (int sweep = 0; sweep < kSweeps; ++sweep)
      for (std::size_t k = 0; k < members_.size(); ++k) {
        const std::size_t v = sweep % 2 == 0 ? k : members_.size() - 1 - k;
        // The first quarter of the sweeps counts all matches: outliers are judged against a settled field.
        if (inPair(v)) complements[v] = balanced(v, complements, sweep >= kSweeps / 4);
      }
  }

 private:
  bool inPair(std::size_t v) const { return (members_[v] & pair_) == pair_; }

  glm::vec2 balanced(std::size_t v, std::span<const glm::vec2> complements, bool doubted) const {
    glm::dvec2 sum(0.0);
    double count = 0;
    for (const std::uint32_t u : neighbours_[v])
      if (inPair(u)) sum += glm::dvec2(complements[u]), ++count;
    const VertexMatch& match = matches_[v];
    const glm::dvec2 wanted(match.displacement);
    double weight = 1;
    if (doubted && count > 0) weight = robustWeight(match.information, wanted - sum / count, options_.outlierPx);
    const glm::dvec3 w = weight * glm::dvec3(match.information);
    const double s = options_.smoothness;
    const double prior = options_.complementPx > 0 ? 1 / (options_.complementPx * options_.complementPx) : 0;
    const double xx = w.x + s * count + prior, yy = w.z + s * count + prior, xy = w.y;
    const glm::dvec2 side = s * sum + glm::dvec2(w.x * wanted.x + w.y * wanted.y, w.y * wanted.x + w.z * wanted.y);
    const double determinant = xx * yy - xy * xy;
    if (!(determinant > 1e-15 * (xx + yy) * (xx + yy))) return complements[v];
    return glm::vec2((yy * side.x - xy * side.y) / determinant, (xx * side.y - xy * side.x) / determinant);
  }

  const Lists& neighbours_;
  std::span<const CameraSet> members_;
  CameraSet pair_;
  std::span<const VertexMatch> matches_;
  const ComplementOptions& options_;
};

}  // namespace

std::vector<glm::vec2> complementsOf(const TriangleMesh& mesh, std::size_t cameras, std::span<const CameraSet> members,
                                     std::span<const VertexMatch> matches, const ComplementOptions& options) {
  const std::size_t n = mesh.positions.size();
  const Lists neighbours = neighboursOfVertices(mesh);
  std::vector<glm::vec2> complements(cameras * cameras * n, glm::vec2(0.0f));
  runJobs(
      cameras * cameras, threadsFor(options.threads, 1e6),
      [&](std::size_t pair) {
        const std::size_t i = pair / cameras, j = pair % cameras;
        if (i == j) return;
        PairField(neighbours, members, CameraSet(1) << i | CameraSet(1) << j, matches.subspan(pair * n, n), options)
            .solve(std::span(complements).subspan(pair * n, n));
      },
      [](std::size_t) { return true; });
  return complements;
}

}  // namespace ibr
