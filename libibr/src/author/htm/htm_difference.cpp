// SPDX-License-Identifier: Apache-2.0
#include "author/htm/htm_difference.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>

#include "base/bilinear.h"
#include "base/parallel.h"

namespace ibr {

std::vector<double> cameraScores(std::span<const double> facing, std::span<const double> size,
                                 const DifferenceOptions& options) {
  const std::size_t n = facing.size();
  std::vector<double> logs(n), scores(n);
  double largest = -std::numeric_limits<double>::infinity(), area = 0, sum = 0;
  for (std::size_t k = 0; k < n; ++k) {
    logs[k] = options.gamma1 * std::log(0.5 * (std::clamp(facing[k], -1.0, 1.0) + 1));
    largest = std::max(largest, logs[k]);
    area += size[k];
  }
  const bool behind = std::isinf(largest);
  for (std::size_t k = 0; k < n; ++k) sum += behind ? 1 : std::exp(logs[k] - largest);
  for (std::size_t k = 0; k < n; ++k) {
    const double direction = (behind ? 1 : std::exp(logs[k] - largest)) / sum;
    const double extent = area > 0 ? size[k] / area : 1 / double(n);
    scores[k] = options.alpha * direction + (1 - options.alpha) * extent;
  }
  return scores;
}

namespace {

class FaceComparison {
 public:
  FaceComparison(const TriangleMesh& mesh, std::span<const ProjectedMesh> views, std::span<const glm::vec2> complements,
                 const DifferenceOptions& options)
      : mesh_(mesh), views_(views), complements_(complements), options_(options) {}

  double difference(std::uint32_t face, CameraSet seen) const {
    const glm::uvec3 t = mesh_.triangles[face];
    const std::array corner{mesh_.positions[t.x], mesh_.positions[t.y], mesh_.positions[t.z]};
    std::vector<std::size_t> cameras;
    std::vector<double> facing, size;
    double longest = 0;
    constexpr double kMaxAreaPx2 = 1e100;  // px²: near a corner behind the camera the area overflows, and gets no share
    const glm::dvec3 normal = glm::cross(corner[1] - corner[0], corner[2] - corner[0]);
    const glm::dvec3 middle = (corner[0] + corner[1] + corner[2]) / 3.0;
    if (!(glm::length(normal) > 0)) return 0;
    for (std::size_t k = 0; k < views_.size(); ++k) {
      if (!(seen >> k & 1)) continue;
      std::array<glm::dvec2, 3> at;
      bool before = true;
      for (std::size_t c = 0; c < 3; ++c) {
        const auto point = views_[k].view.seen(corner[c]);
        before = before && point;
        if (point) at[c] = point->pixel;
      }
      if (!before) continue;
      const glm::dvec2 ab = at[1] - at[0], ac = at[2] - at[0];
      cameras.push_back(k);
      facing.push_back(glm::dot(glm::normalize(normal), glm::normalize(views_[k].view.centre() - middle)));
      size.push_back(std::fmin(0.5 * std::abs(ab.x * ac.y - ab.y * ac.x), kMaxAreaPx2));
      for (std::size_t c = 0; c < 3; ++c) longest = std::max(longest, glm::distance(at[c], at[(c + 1) % 3]));
    }
    if (cameras.size() < 2) return 0;
    const std::vector<double> scores = cameraScores(facing, size, options_);
    const std::size_t best = std::size_t(std::ranges::max_element(scores) - scores.begin());
    double sum = 0;
    std::size_t compared = 0;
    for (std::size_t c = 0; c < cameras.size(); ++c) {
      if (c == best) continue;
      const double apart = meanDifference(face, corner, cameras[c], cameras[best], longest);
      if (std::isnan(apart)) continue;
      sum += scores[c] * apart;
      ++compared;
    }
    return compared > 0 ? sum / double(compared) : 0;
  }

 private:
  // Eq. 1 between image k and image `best` warped onto k (Alg. 5); NaN if they share no pixel (n_p = 0).
  double meanDifference(std::uint32_t face, const std::array<glm::dvec3, 3>& corner, std::size_t k, std::size_t best,
                        double longestPx) const {
    const int n = int(std::ceil(std::clamp(longestPx / 2, 2.0, 16.0)));
    const std::size_t vertices = mesh_.positions.size(), first = (k * views_.size() + best) * vertices;
    double sum = 0;
    int samples = 0;
    const auto sample = [&](double b, double c) {
      const glm::dvec3 point = (1 - b - c) * corner[0] + b * corner[1] + c * corner[2];
      const auto here = views_[k].visible(point), there = views_[best].visible(point);
      if (!here || !there) return;
      glm::dvec2 read = *here;
      if (!complements_.empty()) {
        const glm::uvec3 t = mesh_.triangles[face];
        read += glm::dvec2(complements_[first + t.x]) * (1 - b - c) + glm::dvec2(complements_[first + t.y]) * b +
                glm::dvec2(complements_[first + t.z]) * c;
      }
      const glm::dvec3 apart = glm::abs(bilinear(*views_[best].picture, *there) - bilinear(*views_[k].picture, read));
      sum += apart.x + apart.y + apart.z;
      ++samples;
    };
    for (int i = 0; i < n; ++i)
      for (int j = 0; i + j < n; ++j) {
        sample((i + 1.0 / 3) / n, (j + 1.0 / 3) / n);
        if (i + j + 1 < n) sample((i + 2.0 / 3) / n, (j + 2.0 / 3) / n);
      }
    return samples > 0 ? sum / (3.0 * samples) : std::numeric_limits<double>::quiet_NaN();
  }

  const TriangleMesh& mesh_;
  std::span<const ProjectedMesh> views_;
  std::span<const glm::vec2> complements_;
  const DifferenceOptions& options_;
};

}  // namespace

std::vector<double> faceDifferences(const TriangleMesh& mesh, std::span<const ProjectedMesh> views,
                                    std::span<const FaceVisibility> visibility, std::span<const glm::vec2> complements,
                                    std::span<const std::uint32_t> faces, const DifferenceOptions& options,
                                    int threads) {
  const FaceComparison comparison(mesh, views, complements, options);
  std::vector<double> differences(faces.size(), 0);
  constexpr std::size_t kBlock = 256;
  runJobs((faces.size() + kBlock - 1) / kBlock, threadsFor(threads, 1e6),
          [&](std::size_t block) {
            for (std::size_t f = block * kBlock; f < std::min(faces.size(), (block + 1) * kBlock); ++f)
              differences[f] = comparison.difference(faces[f], visibility[faces[f]].seen);
          },
          [](std::size_t) { return true; });
  return differences;
}

}  // namespace ibr
