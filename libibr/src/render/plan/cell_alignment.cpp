// SPDX-License-Identifier: Apache-2.0
#include "render/plan/cell_alignment.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/mat3x3.hpp>

#include "render/plan/alignment_fit.h"
#include "render/plan/anchors.h"
#include "render/plan/correction.h"

namespace ibr {
namespace {

constexpr double kRegularisation = 1e-3;  // κ
constexpr double kMinAngle = 1e-6;        // radians: smaller motions are dropped; exact scenes stay bit-identical
constexpr std::size_t kMinPairs = 8;

using Anchors = std::span<const CellBounds::Anchor>;
using Observations = std::pmr::vector<Observation>;
using Motions = std::pmr::vector<Motion>;

// Returns the directions and nearnesses of a cell's anchors, seen from the eye.
Observations observationsOf(const Scene& scene, const Cell& cell, Anchors anchors, const Weights& weights,
                            glm::dvec3 eye, const Correction& correction, std::pmr::memory_resource* memory) {
  std::array<glm::dmat3, 4> toWorld;
  glm::dvec3 shift(0.0);
  for (std::size_t i = 0; i < cell.members.size(); ++i) {
    const Pose& pose = scene.nodes[cell.members[i]].camera.pose;
    toWorld[i] = weights[i] * glm::mat3_cast(correction.rotation * glm::normalize(pose.rotation));
    shift += weights[i] * (pose.position - eye);
  }
  shift = corrected(correction, shift, eye);
  Observations observations(memory);
  observations.reserve(anchors.size());
  for (const CellBounds::Anchor& anchor : anchors) {
    glm::dvec3 direction = double(anchor.point.inverseDistance) * shift;
    for (std::size_t i = 0; i < cell.members.size(); ++i) direction += toWorld[i] * glm::dvec3(anchor.point.point[i]);
    const double length = glm::length(direction);
    observations.push_back({direction / length, double(anchor.point.inverseDistance) / length});
  }
  return observations;
}

// Calls `visit` with both anchors' indices for each grid point that two cells share.
template <class Visit>
void forCommon(Anchors a, Anchors b, Visit&& visit) {
  const auto key = [](const CellBounds::Anchor& anchor) { return std::pair(anchor.photograph, anchor.gridCell); };
  for (std::size_t i = 0, j = 0; i < a.size() && j < b.size();) {
    const auto left = key(a[i]), right = key(b[j]);
    if (left == right) visit(i, j);
    i += left <= right;
    j += right <= left;
  }
}

bool sharePhotograph(const Cell& a, const Cell& b) {
  return std::ranges::any_of(a.members, [&](std::uint32_t node) { return std::ranges::count(b.members, node) > 0; });
}

// Two cells, and the motion that aligns the second with the first.
struct CellLink {
  std::size_t a, b;
  MotionFit fit;
  double strength;
};

class Aligner {
 public:
  Aligner(const Scene& scene, std::span<const CellToAlign> cells, glm::dvec3 middle, std::pmr::memory_resource* memory)
      : scene_(scene), cells_(cells), middle_(middle), memory_(memory) {
    for (const CellToAlign& cell : cells)
      observations_.push_back(observationsOf(scene, *cell.cell, cell.anchors, cell.weights, middle, {}, memory));
    normaliseNearness();
    findMasses();
    for (std::size_t a = 0; a < cells.size(); ++a)
      for (std::size_t b = a + 1; b < cells.size(); ++b)
        if (sharePhotograph(*cells[a].cell, *cells[b].cell)) link(a, b);
  }

  std::pmr::vector<Correction> run() {
    const Motions motions = solve();
    std::pmr::vector<Correction> corrections(memory_);
    for (std::size_t m = 0; m < cells_.size(); ++m) corrections.push_back(correctionOf(motions[m], observations_[m]));
    return corrections;
  }

 private:
  // Translations are measured in units of a typical distance, so that the world's scale has no influence.
  void normaliseNearness() {
    double sum = 0;
    std::size_t count = 0;
    for (const Observations& observations : observations_)
      for (const Observation& observation : observations)
        if (std::isfinite(observation.nearness)) sum += observation.nearness, ++count;
    if (sum > 0 && std::isfinite(sum)) unit_ = double(count) / sum;
    for (Observations& observations : observations_)
      for (Observation& observation : observations) observation.nearness *= unit_;
  }

  void findMasses() {
    double furthest = 0;
    for (const CellToAlign& cell : cells_) furthest = std::max(furthest, cell.distance);
    least_ = 1e-12 * furthest * furthest;
    for (const CellToAlign& cell : cells_) {
      const double far = furthest > 0 ? cell.distance / furthest : 1.0;
      masses_.push_back(1 / (far + 1e-12));
    }
  }

  // Weight of a photograph's anchors: the inverse squared distance of the photograph from the views.
  double weightOf(std::uint32_t photograph) const {
    const glm::dvec3 away = scene_.nodes[photograph].camera.pose.position - middle_;
    return 1 / (glm::dot(away, away) + std::max(least_, 1e-300));
  }

  void link(std::size_t a, std::size_t b) {
    pairs_.clear();
    double total = 0;
    std::uint32_t last = ~0u;
    double weight = 0;
    const Anchors anchors = cells_[a].anchors;
    forCommon(anchors, cells_[b].anchors, [&](std::size_t i, std::size_t j) {
      if (anchors[i].photograph != last) {
        weight = weightOf(last = anchors[i].photograph);
        total += weight;
      }
      const Observation &to = observations_[a][i], &from = observations_[b][j];
      const double apart = glm::distance(to.direction, from.direction);
      if (apart < 3 * kMaxCorrectionRadians) pairs_.push_back({from, to, weight});  // skips NaN
    });
    if (pairs_.size() < kMinPairs) return;
    for (ObservationPair& pair : pairs_) pair.weight /= total * (kAnchorSide * kAnchorSide);
    MotionFit fit = fitMotion(pairs_, memory_);
    // Residuals that a rigid motion does not explain come from wrong matches or shapes, not from poses: scale down.
    for (double& value : fit.motion) value *= fit.explained;
    links_.push_back({a, b, fit, std::sqrt(masses_[a] * masses_[b])});
  }

  // Sets `result` to A·x of the normal equations.
  void apply(const Motions& x, Motions& result) const {
    for (std::size_t m = 0; m < x.size(); ++m)
      for (std::size_t i = 0; i < 6; ++i) result[m][i] = kRegularisation * masses_[m] * x[m][i];
    for (const CellLink& link : links_) {
      Motion apart;
      for (std::size_t i = 0; i < 6; ++i) apart[i] = x[link.b][i] - x[link.a][i];
      pull(link, apart, result);
    }
  }
  static void pull(const CellLink& link, const Motion& apart, Motions& to) {
    for (std::size_t i = 0; i < 6; ++i) {
      double sum = 0;
      for (std::size_t j = 0; j < 6; ++j) sum += link.fit.information[i][j] * apart[j];
      to[link.a][i] -= link.strength * sum;
      to[link.b][i] += link.strength * sum;
    }
  }

  // Conjugate gradients with a diagonal preconditioner.
  Motions solve() const {
    const std::size_t n = cells_.size();
    Motions x(n, memory_), residual(n, memory_), diagonal(n, memory_), preconditioned(n, memory_), image(n, memory_);
    for (std::size_t m = 0; m < n; ++m) diagonal[m].fill(kRegularisation * masses_[m]);
    for (const CellLink& link : links_) {
      pull(link, link.fit.motion, residual);
      for (const std::size_t m : {link.a, link.b})
        for (std::size_t i = 0; i < 6; ++i) diagonal[m][i] += link.strength * link.fit.information[i][i];
    }
    const auto precondition = [&] {
      for (std::size_t m = 0; m < n; ++m)
        for (std::size_t i = 0; i < 6; ++i) preconditioned[m][i] = residual[m][i] / diagonal[m][i];
    };
    const auto dot = [&](const Motions& v, const Motions& w) {
      double sum = 0;
      for (std::size_t m = 0; m < n; ++m)
        for (std::size_t i = 0; i < 6; ++i) sum += v[m][i] * w[m][i];
      return sum;
    };
    precondition();
    Motions direction(preconditioned, memory_);
    double energy = dot(residual, preconditioned);
    const double enough = 1e-20 * energy;
    for (std::size_t step = 0; step < 6 * n && energy > enough && energy > 0; ++step) {
      apply(direction, image);
      const double length = energy / dot(direction, image);
      for (std::size_t m = 0; m < n; ++m)
        for (std::size_t i = 0; i < 6; ++i) {
          x[m][i] += length * direction[m][i];
          residual[m][i] -= length * image[m][i];
        }
      precondition();
      const double next = dot(residual, preconditioned);
      for (std::size_t m = 0; m < n; ++m)
        for (std::size_t i = 0; i < 6; ++i) direction[m][i] = preconditioned[m][i] + next / energy * direction[m][i];
      energy = next;
    }
    return x;
  }

  Correction correctionOf(Motion motion, const Observations& observations) const {
    double nearest = 0;
    for (const Observation& observation : observations) nearest = std::max(nearest, observation.nearness);
    const double angle =
        std::hypot(motion[0], motion[1], motion[2]) + nearest * std::hypot(motion[3], motion[4], motion[5]);
    if (!(angle >= kMinAngle)) return {};
    for (double& value : motion) value *= std::min(1.0, kMaxCorrectionRadians / angle);
    Correction correction{rotationOf(motion), middle_, {}};
    correction.shift = glm::conjugate(correction.rotation) * (unit_ * glm::dvec3(motion[3], motion[4], motion[5]));
    return correction;
  }

  const Scene& scene_;
  std::span<const CellToAlign> cells_;
  glm::dvec3 middle_;
  std::pmr::memory_resource* memory_;
  std::pmr::vector<Observations> observations_{memory_};
  std::pmr::vector<double> masses_{memory_};
  std::pmr::vector<CellLink> links_{memory_};
  std::pmr::vector<ObservationPair> pairs_{memory_};
  double unit_ = 1;   // length unit of translations, world units
  double least_ = 0;  // lower bound of squared distances, world units²
};

}  // namespace

std::pmr::vector<Correction> alignCells(const Scene& scene, std::span<const CellToAlign> cells, glm::dvec3 middle,
                                        std::pmr::memory_resource* memory) {
  return Aligner(scene, cells, middle, memory).run();
}

std::vector<double> misalignmentsPx(const Scene& scene, const SceneBounds& bounds, const FramePlan& plan,
                                    std::size_t view, bool corrected) {
  const Camera& camera = plan.views[view];
  const auto pixelOf = [&](const Observation& observation) -> std::optional<glm::dvec2> {
    const auto pixel = project(camera.intrinsics, glm::conjugate(camera.pose.rotation) * observation.direction);
    const bool inside = pixel && pixel->x >= 0 && pixel->y >= 0 && pixel->x <= camera.intrinsics.width &&
                        pixel->y <= camera.intrinsics.height;
    return inside ? pixel : std::nullopt;
  };
  struct Drawn {
    Anchors anchors;
    Observations observations;
  };
  std::vector<Drawn> drawn;
  for (const PlannedCell& cell : plan.cells) {
    const Anchors anchors = bounds.anchors->of(scene)[cell.cell];
    drawn.push_back(
        {anchors, observationsOf(scene, scene.cells[cell.cell], anchors, cell.view[view].position, camera.pose.position,
                                 corrected ? cell.correction : Correction{}, std::pmr::get_default_resource())});
  }
  std::vector<double> apart;
  for (std::size_t a = 0; a < drawn.size(); ++a)
    for (std::size_t b = a + 1; b < drawn.size(); ++b)
      forCommon(drawn[a].anchors, drawn[b].anchors, [&](std::size_t i, std::size_t j) {
        const auto here = pixelOf(drawn[a].observations[i]), there = pixelOf(drawn[b].observations[j]);
        if (here && there) apart.push_back(glm::distance(*here, *there));
      });
  return apart;
}

}  // namespace ibr
