// SPDX-License-Identifier: Apache-2.0
#include "optimise/insertion.h"

#include <algorithm>
#include <array>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <optional>

#include "optimise/alignment_backend.h"
#include "optimise/mesh_edges.h"
#include "optimise/triangle_agreement.h"
#include "optimise/workers.h"

namespace ibr {
namespace {

constexpr double kMinSamples = 50;  // of a triangle, so that its parts can still be judged
constexpr int kPasses = 2;          // triangles that were always beside a worse one then wait for the next cycle
constexpr int kTrialCycles = 2;     // the second one with half the radius

// One new point and the triangles that it splits.
struct Trial {
  InsertedPoint point;
  std::vector<std::size_t> triangle;      // indices
  std::vector<glm::uvec3> before, after;  // after: the new point is the last corner
  double surplus = -1;                    // rise of the ECC beyond the required gain
};

glm::ivec2 meanOf(const std::vector<glm::ivec2>& at, const InsertedPoint& point) {
  glm::dvec2 mean(0.0);
  for (int k = 0; k < 3; ++k) mean += point.weight[k] * glm::dvec2(at[point.parent[k]]);
  return glm::ivec2(glm::round(mean));
}

glm::vec2 meanDirection(const std::vector<glm::vec2>& along, const InsertedPoint& point) {
  glm::dvec2 mean(0.0);
  for (int k = 0; k < 3; ++k) {
    const glm::dvec2 one(along[point.parent[k]]);
    mean += point.weight[k] * (glm::dot(one, mean) < 0 ? -one : one);  // lines have no orientation
  }
  const double length = glm::length(mean);
  return length > 0 ? glm::vec2(mean / length) : glm::vec2(0);
}

void addPoint(Alignment& a, const InsertedPoint& point) {
  for (auto& at : a.position) at.push_back(meanOf(at, point));
  for (auto& along : a.epipolar) along.push_back(meanDirection(along, point));
  if (!a.fixed.empty()) a.fixed.push_back(0);
  a.inserted.push_back(point);
}

// Replaces a split triangle by its parts, whose new point is `n`: the first parts take its index.
void split(Alignment& a, const Trial& trial, std::uint32_t n) {
  for (std::size_t k = 0; k < trial.after.size(); ++k) {
    glm::uvec3 part = trial.after[k];
    part.z = n;
    if (k < trial.triangle.size())
      a.triangles[trial.triangle[k]] = part;
    else
      a.triangles.push_back(part);
  }
}

class Insertions {
 public:
  Insertions(Alignment& alignment, Positions& began, const std::vector<Texels>& pictures,
             const AlignmentOptions& options, const InsertRequest& request, const std::function<void()>& keepGoing)
      : alignment_(alignment),
        began_(began),
        pictures_(pictures),
        options_(options),
        request_(request),
        keepGoing_(keepGoing),
        done_(alignment.triangles.size(), false) {
    options_.levels = 1;
  }

  std::size_t run() {
    const std::vector<std::size_t> worst = candidates();
    std::size_t added = 0;
    for (int pass = 0; pass < kPasses && added < request_.most; ++pass) {
      edges_ = MeshEdges(alignment_);
      std::vector<Trial> trials = trialsOf(worst);
      if (trials.empty()) break;
      optimiseTrials(trials, std::uint32_t(pass));
      std::erase_if(trials, [](const Trial& t) { return !(t.surplus > 0); });
      std::ranges::stable_sort(trials, std::greater<>{}, &Trial::surplus);
      trials.resize(std::min(trials.size(), request_.most - added));
      for (const Trial& trial : trials) add(trial);
      added += trials.size();
    }
    return added;
  }

 private:
  // Triangles with low ECC that have enough samples and texture, the worst first.
  std::vector<std::size_t> candidates() const {
    std::vector<std::optional<TriangleAgreement>> agreed(alignment_.triangles.size());
    forEachInParallel(agreed.size(), options_.threads, [&](std::size_t t) {
      agreed[t] = agreement({&alignment_.triangles[t], 1});
    });
    std::vector<std::size_t> worst;
    for (std::size_t t = 0; t < agreed.size(); ++t)
      if (agreed[t] && agreed[t]->ecc < options_.insertBelow && agreed[t]->samples >= kMinSamples &&
          agreed[t]->variance >= options_.varianceFloor)
        worst.push_back(t);
    std::ranges::stable_sort(worst, {}, [&](std::size_t t) { return agreed[t]->ecc; });
    return worst;
  }

  std::optional<TriangleAgreement> agreement(std::span<const glm::uvec3> triangles) const {
    return agreementOf(pictures_, alignment_.position, triangles, options_.varianceFloor);
  }

  // Trials never share a triangle; a conflicting one waits for the next pass.
  std::vector<Trial> trialsOf(const std::vector<std::size_t>& worst) {
    std::vector<bool> taken(alignment_.triangles.size(), false);
    std::vector<Trial> trials;
    for (const std::size_t t : worst) {
      if (done_[t] || taken[t]) continue;
      const std::optional<Trial> trial = trialOf(t);
      if (trial && std::ranges::any_of(trial->triangle, [&](std::size_t s) { return taken[s]; })) continue;
      done_[t] = true;
      if (!trial) continue;
      for (const std::size_t s : trial->triangle) taken[s] = true;
      trials.push_back(*trial);
    }
    return trials;
  }

  std::optional<Trial> trialOf(std::size_t t) const {
    const glm::uvec3 corner = alignment_.triangles[t];
    std::array<int, 3> side{0, 1, 2};
    std::ranges::stable_sort(side, std::greater<>{}, [&](int k) { return length(corner[k], corner[(k + 1) % 3]); });
    for (const int k : side) {
      const std::uint32_t a = corner[k], b = corner[(k + 1) % 3];
      const std::size_t s = edges_.beyond(a, b);
      if (s == MeshEdges::none) continue;
      const std::uint32_t c = opposite(corner, a, b), d = opposite(alignment_.triangles[s], a, b);
      Trial trial{{{a, b, b}, {0.5, 0.5, 0.0}}, {t, s}, {corner, alignment_.triangles[s]}, {}};
      trial.after = {{c, a, 0}, {d, b, 0}, {b, c, 0}, {a, d, 0}};
      if (isValid(trial)) return trial;
    }
    constexpr double kThird = 1.0 / 3.0;
    Trial trial{{corner, glm::dvec3(kThird)}, {t}, {corner}, {}};
    for (int k = 0; k < 3; ++k) trial.after.emplace_back(corner[k], corner[(k + 1) % 3], 0);
    return isValid(trial) ? std::optional(trial) : std::nullopt;
  }

  // Squared length of an edge, of its vector summed over all images.
  double length(std::uint32_t a, std::uint32_t b) const {
    glm::dvec2 way(0.0);
    for (const auto& at : alignment_.position) way += glm::dvec2(at[b] - at[a]);
    return glm::dot(way, way);
  }

  // True if no part is folded over with the new point at its start position.
  bool isValid(const Trial& trial) const {
    Positions corners(alignment_.position.size());
    for (const glm::uvec3& part : trial.after) {
      for (std::size_t i = 0; i < corners.size(); ++i) {
        const auto& at = alignment_.position[i];
        corners[i] = {at[part.x], at[part.y], meanOf(at, trial.point)};
      }
      if (!isUnfolded(corners, {0, 1, 2})) return false;
    }
    return std::ranges::all_of(trial.before, [&](const glm::uvec3& t) { return isUnfolded(alignment_.position, t); });
  }

  // Moves all new points at once and nothing else: no trial depends on another.
  void optimiseTrials(std::vector<Trial>& trials, std::uint32_t pass) {
    Alignment grown = alignment_;
    const std::size_t n = grown.position[0].size();
    grown.fixed.assign(n, 1);
    for (std::size_t k = 0; k < trials.size(); ++k) {
      addPoint(grown, trials[k].point);
      split(grown, trials[k], std::uint32_t(n + k));
    }
    const StarMesh mesh = starMeshOf(grown);
    Positions at = grown.position;
    const BackendInput input{mesh, pictures_, options_, grown};
    const auto mover =
        options_.method == AlignmentMethod::gradient ? makeGradientBackend(input) : makeCpuBackend(input);
    for (std::uint32_t c = 0; c < std::uint32_t(kTrialCycles); ++c)
      mover->cycle({std::max(request_.radius >> c, 1), shader::eccHash(request_.seed, pass * kTrialCycles + c)}, at,
                   keepGoing_);
    forEachInParallel(trials.size(), options_.threads, [&](std::size_t k) {
      Trial& trial = trials[k];
      for (glm::uvec3& part : trial.after) part.z = std::uint32_t(n + k);
      const auto after = agreementOf(pictures_, at, trial.after, options_.varianceFloor);
      trial.surplus = surplusOf(agreement(trial.before), after, options_.insertGain);
    });
    // The guard has already been called for points that moved.
    for (std::size_t k = 0; options_.guard && k < trials.size(); ++k) {
      const auto point = std::uint32_t(n + k);
      const std::vector<glm::ivec2> match = matchOf(at, point);
      if (match == matchOf(grown.position, point) && !options_.guard(point, match)) trials[k].surplus = -1;
    }
    found_ = std::move(at);
  }

  void add(const Trial& trial) {
    const std::uint32_t was = trial.after[0].z, n = std::uint32_t(alignment_.position[0].size());
    addPoint(alignment_, trial.point);
    split(alignment_, trial, n);
    for (std::size_t i = 0; i < found_.size(); ++i) {
      began_[i].push_back(alignment_.position[i][n]);
      alignment_.position[i][n] = found_[i][was];
    }
    for (const std::size_t t : trial.triangle) done_[t] = true;
    done_.resize(alignment_.triangles.size(), true);
  }

  Alignment& alignment_;
  Positions& began_;
  const std::vector<Texels>& pictures_;
  AlignmentOptions options_;
  const InsertRequest& request_;
  const std::function<void()>& keepGoing_;
  std::vector<bool> done_;  // triangles that were tried, or are new
  MeshEdges edges_;
  Positions found_;  // after the last trials
};

}  // namespace

std::size_t insertPoints(Alignment& alignment, Positions& began, const std::vector<Texels>& pictures,
                         const AlignmentOptions& options, const InsertRequest& request,
                         const std::function<void()>& keepGoing) {
  return Insertions(alignment, began, pictures, options, request, keepGoing).run();
}

}  // namespace ibr
