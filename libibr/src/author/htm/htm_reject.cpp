// SPDX-License-Identifier: Apache-2.0
#include "author/htm/htm_reject.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <glm/geometric.hpp>

#include "author/htm/htm_shape.h"
#include "base/bilinear.h"
#include "base/parallel.h"

namespace ibr {
namespace {

constexpr std::size_t kMinSamples = 16;

CameraAgreement compared(const Image8& picture, const std::vector<TemplateSample>& samples, glm::dvec2 complement) {
  if (samples.size() < kMinSamples) return {};
  glm::dvec3 sumA(0.0), sumB(0.0), apart(0.0), squaresA(0.0), squaresB(0.0), products(0.0);
  for (const TemplateSample& sample : samples) {
    const glm::dvec3 a(sample.red, sample.green, sample.blue);
    const glm::dvec3 b = bilinear(picture, glm::dvec2(sample.x + 0.5, sample.y + 0.5) + complement);
    apart += glm::abs(a - b);
    sumA += a, sumB += b;
    squaresA += a * a, squaresB += b * b, products += a * b;
  }
  const double n = double(samples.size());
  const auto total = [](const glm::dvec3& v) { return v.x + v.y + v.z; };
  const double varianceA = total(squaresA - sumA * sumA / n), varianceB = total(squaresB - sumB * sumB / n);
  const double scale = std::sqrt(varianceA * varianceB);
  return {float(total(apart) / (3 * n)), scale > 1e-9 ? float(total(products - sumA * sumB / n) / scale) : 0.0f, true};
}

// Bron and Kerbosch 1973, with an upper bound on the score that is still reachable.
class CliqueSearch {
 public:
  CliqueSearch(std::span<const CameraSet> joined, std::span<const float> scores) : joined_(joined), scores_(scores) {}

  CameraSet largest(CameraSet among) {
    extend(0, among);
    return best_;
  }

 private:
  float score(CameraSet set) const {
    float sum = 0;
    for (CameraSet rest = set; rest; rest &= rest - 1) sum += scores_[std::size_t(std::countr_zero(rest))];
    return sum;
  }
  void extend(CameraSet chosen, CameraSet candidates) {
    if (!candidates) {
      if (std::popcount(chosen) > std::popcount(best_) ||
          (std::popcount(chosen) == std::popcount(best_) && score(chosen) > score(best_)))
        best_ = chosen;
      return;
    }
    if (std::popcount(chosen) + std::popcount(candidates) < std::popcount(best_)) return;
    if (++steps_ > kMaxSteps && best_) return;
    // Try the candidate with the most partners first: the search soon has a greedy answer.
    int first = -1, most = -1;
    for (CameraSet rest = candidates; rest; rest &= rest - 1) {
      const int c = std::countr_zero(rest), partners = std::popcount(candidates & joined_[std::size_t(c)]);
      if (partners > most) most = partners, first = c;
    }
    const CameraSet bit = CameraSet(1) << first;
    extend(chosen | bit, candidates & joined_[std::size_t(first)]);
    // Without this candidate, a better set must include one that is not joined to it.
    if (candidates & ~joined_[std::size_t(first)] & ~bit) extend(chosen, candidates & ~bit);
  }

  static constexpr std::size_t kMaxSteps = 100000;
  std::span<const CameraSet> joined_;
  std::span<const float> scores_;
  CameraSet best_ = 0;
  std::size_t steps_ = 0;
};

}  // namespace

CameraSet largestClique(CameraSet among, std::span<const CameraSet> joined, std::span<const float> scores) {
  return CliqueSearch(joined, scores).largest(among);
}

std::vector<CameraAgreement> agreements(const TriangleMesh& mesh, std::span<const ProjectedMesh> views,
                                        std::span<const CameraSet> members, std::span<const glm::vec2> complements,
                                        const SegmentOptions& segment, int threads) {
  const std::size_t n = mesh.positions.size(), cameras = views.size();
  const Lists faces = facesAtVertices(mesh);
  std::vector<CameraAgreement> all(cameras * cameras * n);
  runJobs(
      cameras, threadsFor(threads, 1e7),
      [&](std::size_t i) {
        const auto segments = segmentsOf(mesh, faces, views[i], segment, members, i);
        for (std::size_t j = 0; j < cameras; ++j) {
          if (j == i) continue;
          Recoloured recoloured(views[i], views[j]);
          for (std::size_t v = 0; v < n; ++v) {
            if (!(members[v] >> i & 1) || !(members[v] >> j & 1)) continue;
            const std::size_t k = (i * cameras + j) * n + v;
            const glm::dvec2 complement = complements.empty() ? glm::dvec2(0) : glm::dvec2(complements[k]);
            all[k] = compared(*views[i].picture, recoloured.of(segments[v]), complement);
          }
        }
      },
      [](std::size_t) { return true; });
  return all;
}

std::vector<float> facingScores(const TriangleMesh& mesh, std::span<const ProjectedMesh> views) {
  const std::vector<glm::dvec3> normal = vertexNormals(mesh);
  std::vector<float> scores;
  for (const ProjectedMesh& view : views)
    for (std::size_t v = 0; v < normal.size(); ++v) {
      const glm::dvec3 towards = view.view.centre() - mesh.positions[v];
      const double lengths = glm::length(normal[v]) * glm::length(towards);
      scores.push_back(lengths > 0 ? float(std::max(0.0, glm::dot(normal[v], towards) / lengths)) : 0.0f);
    }
  return scores;
}

std::vector<CameraSet> agreeingMembers(std::size_t cameras, std::span<const CameraSet> members,
                                       std::span<const CameraAgreement> agreements, std::span<const float> scores,
                                       const RejectOptions& options) {
  const std::size_t n = members.size();
  const auto disagree = [&](std::size_t i, std::size_t j, std::size_t v) {
    const CameraAgreement& a = agreements[(i * cameras + j) * n + v];
    return a.known && a.difference > options.maxDifference && a.correlation < options.minCorrelation;
  };
  std::vector<CameraSet> agreeing(n);
  std::vector<CameraSet> joined(cameras);
  std::vector<float> score(cameras);
  for (std::size_t v = 0; v < n; ++v) {
    for (std::size_t i = 0; i < cameras; ++i) {
      joined[i] = 0;
      score[i] = scores[i * n + v];
      for (std::size_t j = 0; j < cameras; ++j)
        if (i != j && !disagree(i, j, v) && !disagree(j, i, v)) joined[i] |= CameraSet(1) << j;
    }
    agreeing[v] = largestClique(members[v], joined, score);
  }
  return agreeing;
}

}  // namespace ibr
