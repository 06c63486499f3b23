// SPDX-License-Identifier: Apache-2.0
#include "ibr/author/poses.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
#include <opencv2/core.hpp>

namespace ibr {
namespace {

constexpr int kRounds = 20;
constexpr double kMinRadians = 1e-7, kMinShift = 1e-7;  // rounding limit of the sums of squares; of the extent

// The rotation nearest to a matrix (Kabsch 1976).
glm::dmat3 nearestRotation(const glm::dmat3& m) {
  cv::Matx33d matrix;
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c) matrix(r, c) = m[c][r];
  cv::Matx31d w;
  cv::Matx33d u, vt;
  cv::SVD::compute(matrix, w, u, vt);
  const double sign = cv::determinant(u * vt) < 0 ? -1 : 1;
  const cv::Matx33d found = u * cv::Matx33d::diag({1, 1, sign}) * vt;
  glm::dmat3 rotation;
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c) rotation[c][r] = found(r, c);
  return rotation;
}

}  // namespace

SimilarityTransform estimateSimilarity(std::span<const Pose> from, std::span<const Pose> to) {
  if (from.empty()) return {};
  const double n = double(from.size());
  glm::dvec3 middleFrom(0.0), middleTo(0.0);
  for (std::size_t i = 0; i < from.size(); ++i) {
    middleFrom += from[i].position / n;
    middleTo += to[i].position / n;
  }
  glm::dmat3 byRotations(0.0), byPositions(0.0);
  double spreadFrom = 0, spreadTo = 0;
  for (std::size_t i = 0; i < from.size(); ++i) {
    const glm::dvec3 a = from[i].position - middleFrom, b = to[i].position - middleTo;
    byRotations += glm::mat3_cast(to[i].rotation * glm::conjugate(from[i].rotation));
    byPositions += glm::outerProduct(b, a);
    spreadFrom += glm::dot(a, a);
    spreadTo += glm::dot(b, b);
  }
  // Expanded sums of squares: Σ θ² = 3n − tr(RᵀM_r), Σ d² = spreadTo + s² spreadFrom − 2 s tr(RᵀM_p).
  const auto along = [](const glm::dmat3& a, const glm::dmat3& b) {
    return glm::dot(a[0], b[0]) + glm::dot(a[1], b[1]) + glm::dot(a[2], b[2]);
  };
  glm::dmat3 rotation = nearestRotation(byRotations);
  const bool spread = spreadFrom > 0 && spreadTo > 0;
  double scale = 1;
  for (int round = 0; spread && round < kRounds; ++round) {
    scale = along(rotation, byPositions) / spreadFrom;
    if (!(scale > 0)) scale = std::sqrt(spreadTo / spreadFrom);
    const double turned = std::max(3 * n - along(rotation, byRotations), n * kMinRadians * kMinRadians);
    const double shifted = std::max(spreadTo + scale * scale * spreadFrom - 2 * scale * along(rotation, byPositions),
                                    spreadTo * kMinShift * kMinShift);
    rotation = nearestRotation(byRotations / turned + 2 * scale / shifted * byPositions);
  }
  SimilarityTransform similarity{scale, glm::normalize(glm::quat_cast(rotation)), {}};
  similarity.shift = middleTo - similarity.scale * (similarity.rotation * middleFrom);
  return similarity;
}

}  // namespace ibr
