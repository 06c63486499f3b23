// SPDX-License-Identifier: Apache-2.0
#include "author/depth/depth_consistency.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>
#include <utility>

#include "author/backdrop/complete_depth.h"
#include "base/parallel.h"
#include "scene/reprojection.h"

namespace ibr {
namespace {

constexpr double kDegree = std::numbers::pi / 180;
constexpr double kMinParallax = 1.5 * kDegree;                                              // for a source to count
constexpr double kBestParallax = 6 * kDegree, kNarrow = 3 * kDegree, kWide = 12 * kDegree;  // Gaussian, σ each side
constexpr double kRelativeTolerance = 0.004;                                                // relative to ρ
constexpr int kGrid = 16;  // sample points per side, for choosing sources

double angleBetween(const glm::dvec3& a, const glm::dvec3& b) {
  return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b));
}

// Projection of a point of one map into another map's image.
struct ReprojectedPoint {
  glm::ivec2 pixel;
  double inverseDepth;   // of the point
  double parallax;       // angle at the point between the two centres, radians
  double distanceRatio;  // distance of the point from the target over that from the source
};
bool reproject(const Reprojection& towards, const Intrinsics& source, glm::dvec2 from, double inverseDepth,
               ReprojectedPoint& reprojected) {
  const glm::dvec3 ray = towards.ray(from), direction = ray + inverseDepth * towards.shift();
  if (!(direction.z < 0)) return false;
  const glm::dvec2 pixel = towards.pixel(direction);
  if (!towards.inside(pixel)) return false;
  reprojected = {{std::min(int(pixel.x), source.width - 1), std::min(int(pixel.y), source.height - 1)},
                 inverseDepth / -direction.z,
                 angleBetween(ray, direction),
                 glm::length(ray) / glm::length(direction)};
  return true;
}

double usefulness(double parallax) {
  if (parallax < kMinParallax) return 0;
  const double off = (parallax - kBestParallax) / (parallax < kBestParallax ? kNarrow : kWide);
  return std::exp(-0.5 * off * off);
}

class Consistency {
 public:
  Consistency(std::span<const ConsistentDepth> depths, std::size_t sources) : depths_(depths), maxSources_(sources) {
    for (const ConsistentDepth& depth : depths) {
      const ImageF& map = depth.map.inverseDepth;
      const Image8 none(map.width, map.height, 1, 0);
      evidence_.push_back({none, none, none});
    }
    sources_.resize(depths.size());
  }

  void chooseSources(std::size_t target) {
    const ImageF& map = depths_[target].map.inverseDepth;
    std::vector<std::pair<double, std::size_t>> scores;
    for (std::size_t j = 0; j < depths_.size(); ++j) {
      if (j == target) continue;
      const Camera& source = depths_[j].map.camera;
      const Reprojection towards(depths_[target].map.camera, source);
      double score = 0;
      for (int row = 0; row < kGrid; ++row)
        for (int column = 0; column < kGrid; ++column) {
          const int x = (2 * column + 1) * map.width / (2 * kGrid), y = (2 * row + 1) * map.height / (2 * kGrid);
          const double w = double(map.pixel(x, y)[0]);
          ReprojectedPoint seen;
          if (w < 0 || !reproject(towards, source.intrinsics, {x + 0.5, y + 0.5}, w, seen)) continue;
          score += usefulness(seen.parallax) * std::min(seen.distanceRatio, 1 / seen.distanceRatio);
        }
      if (score > 0) scores.emplace_back(-score, j);
    }
    std::sort(scores.begin(), scores.end());
    for (std::size_t k = 0; k < std::min(scores.size(), maxSources_); ++k) sources_[target].push_back(scores[k].second);
  }

  void confirm(std::size_t target) {
    forSources(target, [&](int x, int y, std::size_t source, const ReprojectedPoint& seen, double tolerance) {
      const double theirs = double(depths_[source].map.inverseDepth.pixel(seen.pixel.x, seen.pixel.y)[0]);
      const bool agrees = theirs >= 0 && std::abs(theirs - seen.inverseDepth) < tolerance;
      const bool isApart = seen.parallax >= kMinParallax;
      if (isApart) increment(evidence_[target].usableSources, x, y);
      if (isApart && agrees) increment(evidence_[target].confirmations, x, y);
    });
  }

  // Must run after confirm() has finished for all maps.
  void contradict(std::size_t target) {
    forSources(target, [&](int x, int y, std::size_t source, const ReprojectedPoint& seen, double tolerance) {
      if (evidence_[source].confirmations.pixel(seen.pixel.x, seen.pixel.y)[0] == 0) return;
      if (seen.parallax < kMinParallax) {
        const double theirs = double(depths_[source].map.inverseDepth.pixel(seen.pixel.x, seen.pixel.y)[0]);
        if (std::abs(theirs - seen.inverseDepth) >= tolerance) increment(evidence_[target].usableSources, x, y);
        return;
      }
      const ImageF& map = depths_[source].map.inverseDepth;
      for (int v = std::max(0, seen.pixel.y - 1); v <= std::min(map.height - 1, seen.pixel.y + 1); ++v)
        for (int u = std::max(0, seen.pixel.x - 1); u <= std::min(map.width - 1, seen.pixel.x + 1); ++u) {
          const double theirs = double(map.pixel(u, v)[0]);
          if (theirs < 0 || seen.inverseDepth - theirs <= 2 * tolerance) return;
        }
      increment(evidence_[target].contradictions, x, y);
    });
  }

  std::vector<DepthEvidence> take() && { return std::move(evidence_); }

 private:
  static void increment(Image8& counts, int x, int y) {
    std::uint8_t& count = counts.pixel(x, y)[0];
    count = std::uint8_t(std::min(count + 1, 255));
  }

  template <class Visit>
  void forSources(std::size_t target, const Visit& visit) const {
    const Camera& own = depths_[target].map.camera;
    const ImageF& map = depths_[target].map.inverseDepth;
    for (const std::size_t j : sources_[target]) {
      const Camera& source = depths_[j].map.camera;
      const Reprojection towards(own, source);
      const double baseline = glm::distance(own.pose.position, source.pose.position);
      const double residual = depths_[j].residualPx / (source.intrinsics.fx * std::max(baseline, 1e-12));
      for (int y = 0; y < map.height; ++y)
        for (int x = 0; x < map.width; ++x) {
          const double w = double(map.pixel(x, y)[0]);
          ReprojectedPoint seen;
          if (w < 0 || !reproject(towards, source.intrinsics, {x + 0.5, y + 0.5}, w, seen)) continue;
          visit(x, y, j, seen, depths_[j].step + kRelativeTolerance * seen.inverseDepth + residual);
        }
    }
  }

  std::span<const ConsistentDepth> depths_;
  std::size_t maxSources_;
  std::vector<std::vector<std::size_t>> sources_;  // by photograph
  std::vector<DepthEvidence> evidence_;
};

}  // namespace

std::vector<DepthEvidence> depthEvidence(std::span<const ConsistentDepth> depths, std::size_t sources, int threads) {
  return depthEvidence(depths, sources, [&](std::size_t count, const std::function<void(std::size_t)>& job) {
    runJobs(count, threads, job, [](std::size_t) { return true; });
  });
}

std::vector<DepthEvidence> depthEvidence(std::span<const ConsistentDepth> depths, std::size_t sources,
                                         const JobRunner& run) {
  Consistency consistency(depths, sources);
  run(depths.size(), [&](std::size_t i) { consistency.chooseSources(i); });
  run(depths.size(), [&](std::size_t i) { consistency.confirm(i); });
  run(depths.size(), [&](std::size_t i) { consistency.contradict(i); });
  return std::move(consistency).take();
}

}  // namespace ibr
