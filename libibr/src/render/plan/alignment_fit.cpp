// SPDX-License-Identifier: Apache-2.0
//
// To first order a motion (ω, τ) moves u by J·(ω, τ) with J = [−[u]×, n·S], S = I − u uᵀ, so that
//   JᵀJ = [S, n [u]×; −n [u]×, n² S],  Jᵀe = (u × e, n S e).
#include "render/plan/alignment_fit.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/mat3x3.hpp>
#include <vector>

namespace ibr {
namespace {

constexpr int kRounds = 4;
constexpr double kScale = 1.5;            // of the median residual: at this residual a pair has half its weight
constexpr double kMinScale = 1e-5;        // radians
constexpr double kRegularisation = 1e-4;  // share of the pairs' weight, per unknown: holds undetermined unknowns

// Weighted sums over pairs of the normal equations above, at unit directions u.
struct Sums {
  glm::dmat3 rotation{0.0}, translation{0.0};
  glm::dvec3 cross{0.0}, torque{0.0}, force{0.0};
  double weight = 0;

  void add(double w, glm::dvec3 u, double n, glm::dvec3 e) {
    const glm::dmat3 s = w * (glm::dmat3(1.0) - glm::outerProduct(u, u));
    rotation += s;
    translation += n * n * s;
    cross += w * n * u;
    torque += w * glm::cross(u, e);
    force += n * (s * e);
    weight += w;
  }
  std::array<Motion, 6> information() const {
    const glm::dmat3 block(0, cross.z, -cross.y, -cross.z, 0, cross.x, cross.y, -cross.x, 0);  // Σ w n [u]×, by columns
    std::array<Motion, 6> all;
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 3; ++c) {
        all[std::size_t(r)][std::size_t(c)] = rotation[c][r];
        all[std::size_t(r)][std::size_t(c + 3)] = block[c][r];
        all[std::size_t(r + 3)][std::size_t(c)] = block[r][c];
        all[std::size_t(r + 3)][std::size_t(c + 3)] = translation[c][r];
      }
    return all;
  }
};

// `squares`: squared residual of each pair.
double explained(std::span<const ObservationPair> pairs, std::span<const double> squares, double scale) {
  double before = 0, after = 0;
  for (std::size_t p = 0; p < pairs.size(); ++p) {
    const double weight = pairs[p].weight / (1 + squares[p] / scale);
    const glm::dvec3 apart = pairs[p].to.direction - pairs[p].from.direction;
    before += weight * glm::dot(apart, apart);
    after += weight * squares[p];
  }
  return before > 0 ? std::max(1 - after / before, 0.0) : 0.0;
}

}  // namespace

glm::dquat rotationOf(const Motion& motion) {
  const glm::dvec3 vector(motion[0], motion[1], motion[2]);
  const double angle = glm::length(vector);
  return angle > 0 ? glm::angleAxis(angle, vector / angle) : glm::dquat(1, 0, 0, 0);
}

Motion solved(std::array<Motion, 6> a, Motion b) {
  for (std::size_t j = 0; j < 6; ++j) {
    const double before = a[j][j];
    for (std::size_t k = 0; k < j; ++k) a[j][j] -= a[j][k] * a[j][k];
    a[j][j] = a[j][j] > 1e-12 * before ? std::sqrt(a[j][j]) : 0.0;
    for (std::size_t i = j + 1; i < 6; ++i) {
      for (std::size_t k = 0; k < j; ++k) a[i][j] -= a[i][k] * a[j][k];
      a[i][j] = a[j][j] > 0 ? a[i][j] / a[j][j] : 0.0;
    }
  }
  for (std::size_t i = 0; i < 6; ++i) {
    for (std::size_t k = 0; k < i; ++k) b[i] -= a[i][k] * b[k];
    b[i] = a[i][i] > 0 ? b[i] / a[i][i] : 0.0;
  }
  for (std::size_t i = 6; i-- > 0;) {
    for (std::size_t k = i + 1; k < 6; ++k) b[i] -= a[k][i] * b[k];
    b[i] = a[i][i] > 0 ? b[i] / a[i][i] : 0.0;
  }
  return b;
}

MotionFit fitMotion(std::span<const ObservationPair> pairs, std::pmr::memory_resource* memory) {
  MotionFit fit;
  std::pmr::vector<glm::dvec3> seen(pairs.size(), memory), error(pairs.size(), memory);
  std::pmr::vector<double> squares(pairs.size(), memory), sorted(memory);
  for (int round = 0; round < kRounds; ++round) {
    const glm::dmat3 turn = glm::mat3_cast(rotationOf(fit.motion));
    const glm::dvec3 translation(fit.motion[3], fit.motion[4], fit.motion[5]);
    for (std::size_t p = 0; p < pairs.size(); ++p) {
      seen[p] = glm::normalize(turn * pairs[p].from.direction + pairs[p].from.nearness * translation);
      error[p] = pairs[p].to.direction - seen[p];
      squares[p] = glm::dot(error[p], error[p]);
    }
    sorted = squares;
    std::nth_element(sorted.begin(), sorted.begin() + std::ptrdiff_t(sorted.size() / 2), sorted.end());
    const double scale = std::max(kScale * kScale * sorted[sorted.size() / 2], kMinScale * kMinScale);
    Sums sums;
    for (std::size_t p = 0; p < pairs.size(); ++p)
      sums.add(pairs[p].weight / (1 + squares[p] / scale), seen[p], pairs[p].from.nearness, error[p]);
    fit.information = sums.information();
    std::array<Motion, 6> regular = fit.information;
    Motion pull{sums.torque.x, sums.torque.y, sums.torque.z, sums.force.x, sums.force.y, sums.force.z};
    for (std::size_t i = 0; i < 6; ++i) {
      regular[i][i] += kRegularisation * sums.weight;
      pull[i] -= kRegularisation * sums.weight * fit.motion[i];
    }
    const Motion step = solved(regular, pull);
    for (std::size_t i = 0; i < 6; ++i) fit.motion[i] += step[i];
    fit.explained = explained(pairs, squares, scale);
  }
  return fit;
}

}  // namespace ibr
