// SPDX-License-Identifier: Apache-2.0
#include "author/features/epipolar.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/mat3x3.hpp>
#include <limits>
#include <numeric>
#include <utility>

namespace ibr {
namespace {

constexpr float kSlabWidthPx = 16;      // px
constexpr float kSameFeaturePx = 3.0f;  // px: within this distance of the best, a feature counts as the same

// Features in slabs along one axis, sorted along the other.
class Slabs {
 public:
  Slabs(const Features& features, int axis, int size)
      : axis_(axis), slabs_(std::size_t(std::max(1, int(std::ceil(float(size) / kSlabWidthPx))))) {
    std::vector<std::uint32_t> order(features.at.size());
    std::iota(order.begin(), order.end(), 0u);
    std::ranges::stable_sort(order, {}, [&](std::uint32_t i) { return features.at[i][1 - axis]; });
    for (const std::uint32_t i : order) {
      const auto slab = std::clamp(int(features.at[i][axis] / kSlabWidthPx), 0, int(slabs_.size()) - 1);
      slabs_[std::size_t(slab)].push_back({features.at[i][1 - axis], i});
    }
  }

  /// Calls visit(i) for features near the line n.x·x + n.y·y + n.z = 0, |(n.x, n.y)| = 1, whose direction along the
  /// other axis is the smaller part. Some visited features are farther off.
  template <class Visit>
  void near(glm::dvec3 n, double distance, Visit&& visit) const {
    const double along = n[axis_], across = n[1 - axis_];
    const double reach = distance / std::abs(across);
    for (std::size_t s = 0; s < slabs_.size(); ++s) {
      const double at0 = -(along * double(s) * kSlabWidthPx + n.z) / across;
      const double at1 = -(along * double(s + 1) * kSlabWidthPx + n.z) / across;
      const auto low = float(std::min(at0, at1) - reach), high = float(std::max(at0, at1) + reach);
      const auto& slab = slabs_[s];
      for (auto it = std::ranges::lower_bound(slab, low, {}, &Entry::position);
           it != slab.end() && it->position <= high; ++it)
        visit(it->feature);
    }
  }

 private:
  struct Entry {
    float position;
    std::uint32_t feature;
  };
  int axis_;
  std::vector<std::vector<Entry>> slabs_;
};

constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
constexpr int kUnrelatedDistance = 260 * 260;  // squared distance of unrelated descriptors

struct Best {
  std::uint32_t feature = kNone;
  int distance = 0;
};

// For each feature of `a` its best match in `b`.
std::vector<Best> bestOf(const Camera& cameraA, const Features& a, const Camera& cameraB, const Features& b,
                         const GuidedOptions& options) {
  const Intrinsics& k = cameraB.intrinsics;
  const Slabs columns(b, 0, k.width), rows(b, 1, k.height);
  const glm::dquat toB = glm::inverse(cameraB.pose.rotation);
  const glm::dvec3 base = toB * (cameraA.pose.position - cameraB.pose.position);  // centre of A, in B's axes
  std::vector<glm::dvec3> rays;
  for (const glm::vec2 pixel : b.at) rays.push_back(unproject(k, pixel));
  std::vector<Best> result(a.at.size());
  struct Candidate {
    std::uint32_t feature;
    int distance;
  };
  std::vector<Candidate> candidates;
  for (std::uint32_t i = 0; i < a.at.size(); ++i) {
    const glm::dvec3 ray = toB * (cameraA.pose.rotation * unproject(cameraA.intrinsics, a.at[i]));
    const glm::dvec3 plane = glm::cross(ray, base);  // normal of the plane through the two centres and the point
    // plane · (direction of a pixel) as a line in px: directions are ((x − cx)/fx, (cy − y)/fy, −1).
    glm::dvec3 line(plane.x / k.fx, -plane.y / k.fy, -plane.x * k.cx / k.fx + plane.y * k.cy / k.fy - plane.z);
    const double length = std::hypot(line.x, line.y);
    if (!(length > 0)) continue;
    line = line / length;
    candidates.clear();
    const Slabs& slabs = std::abs(line.y) >= std::abs(line.x) ? columns : rows;
    slabs.near(line, options.distancePx, [&](std::uint32_t j) {
      const glm::vec2 p = b.at[j];
      if (!(std::abs(line.x * p.x + line.y * p.y + line.z) <= options.distancePx)) return;
      // base + s·ray = t·rays[j] must have s, t > 0: signs follow from the cross products with ray and with base.
      if (!(glm::dot(glm::cross(rays[j], ray), plane) < 0 && glm::dot(glm::cross(base, rays[j]), plane) < 0)) return;
      candidates.push_back({j, descriptorDistance(a, i, b, j)});
    });
    if (candidates.empty()) continue;
    const Candidate best = *std::ranges::min_element(candidates, [](const Candidate& l, const Candidate& r) {
      return std::pair(l.distance, l.feature) < std::pair(r.distance, r.feature);
    });
    // A single candidate is compared with the typical distance of unrelated descriptors.
    int next = kUnrelatedDistance;
    for (const Candidate& c : candidates)
      if (glm::distance(b.at[c.feature], b.at[best.feature]) > kSameFeaturePx) next = std::min(next, c.distance);
    if (std::sqrt(double(best.distance)) <= options.ratio * std::sqrt(double(next)))
      result[i] = {best.feature, best.distance};
  }
  return result;
}

}  // namespace

std::vector<FeatureMatch> matchGuided(const Camera& cameraA, const Features& a, const Camera& cameraB,
                                      const Features& b, const GuidedOptions& options) {
  const std::vector<Best> forward = bestOf(cameraA, a, cameraB, b, options);
  const std::vector<Best> backward = bestOf(cameraB, b, cameraA, a, options);
  std::vector<FeatureMatch> matches;
  for (std::uint32_t i = 0; i < forward.size(); ++i)
    if (const Best& best = forward[i]; best.feature != kNone && backward[best.feature].feature == i)
      matches.push_back({i, best.feature, best.distance});
  return matches;
}

}  // namespace ibr
