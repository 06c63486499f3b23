// SPDX-License-Identifier: Apache-2.0
#include "render/photographs/photograph_index.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <limits>
#include <numbers>
#include <span>

#include "base/prefetch.h"
#include "render/photographs/photograph_choice.h"
#include "render/photographs/photograph_values.h"
#include "shared/gather.h"

namespace ibr {
namespace {

using TreeNode = PhotographIndex::Node;
using Photograph = PhotographIndex::Photograph;

constexpr double kPi = std::numbers::pi;
// Angle that a displacement along the viewing axis causes, relative to the same displacement across: the mean tangent
// of a view's rays.
constexpr double kAlong = 0.35;
constexpr double kMargin = 1e-6;  // for the rounding of chords

// Chord of the angle between two vectors.
double chord(glm::dvec3 a, glm::dvec3 b) {
  const double lengths = std::sqrt(glm::dot(a, a) * glm::dot(b, b));
  return lengths > 0 ? std::sqrt(std::max(0.0, 2 - 2 * glm::dot(a, b) / lengths)) : 0;
}

double fieldOf(const Intrinsics& k) {
  if (k.model == CameraModel::equirectangular) return 2;
  double largest = 0;
  for (const double x : {0.0, double(k.width)})
    for (const double y : {0.0, double(k.height)})
      largest = std::max(largest, chord({0, 0, -1}, {(x - k.cx) / k.fx, (k.cy - y) / k.fy, -1}));
  return largest;
}

Photograph photographOf(const Scene& scene, std::uint32_t backdrop) {
  const std::uint32_t node = scene.backdrops[backdrop].members[0];
  const Camera& camera = scene.nodes[node].camera;
  return {node, backdrop, camera.pose.position, glm::normalize(viewAxis(camera.pose)), fieldOf(camera.intrinsics)};
}

TreeNode boundsOf(std::span<const Photograph> photographs) {
  TreeNode node;
  glm::dvec3 low(std::numeric_limits<double>::infinity()), high(-low), axes(0.0);
  for (const Photograph& one : photographs) {
    low = glm::min(low, one.position);
    high = glm::max(high, one.position);
    axes += one.axis;
    node.field = std::max(node.field, one.field);
  }
  node.centre = 0.5 * (low + high);
  const double length = glm::length(axes);
  node.axis = length > 0 ? axes / length : glm::dvec3(0, 0, -1);
  for (const Photograph& one : photographs) {
    node.radius = std::max(node.radius, glm::distance(node.centre, one.position));
    node.spread = std::max(node.spread, chord(node.axis, one.axis));
  }
  return node;
}

// Orders by direction while directions differ widely, else by the longest side of the positions' box.
auto orderOf(const TreeNode& node, std::span<const Photograph> photographs) {
  constexpr double kWide = 0.6;  // chord
  std::array<double, 6> low, high;
  low.fill(std::numeric_limits<double>::infinity());
  high.fill(-std::numeric_limits<double>::infinity());
  const auto key = [](const Photograph& one, std::size_t axis) {
    return axis < 3 ? one.position[int(axis)] : one.axis[int(axis) - 3];
  };
  for (const Photograph& one : photographs)
    for (std::size_t a = 0; a < 6; ++a) {
      low[a] = std::min(low[a], key(one, a));
      high[a] = std::max(high[a], key(one, a));
    }
  const std::size_t from = node.spread > kWide ? 3 : 0;
  std::size_t widest = from;
  for (std::size_t a = from; a < from + 3; ++a)
    if (high[a] - low[a] > high[widest] - low[widest]) widest = a;
  return [key, widest](const Photograph& a, const Photograph& b) {
    return key(a, widest) != key(b, widest) ? key(a, widest) < key(b, widest) : a.backdrop < b.backdrop;
  };
}

// Angle that a displacement of t depths causes: 0 to 1.57, at first t.
double angleOfShift(double t) {
  return t / (1 + 2 / kPi * t);
}

// Promises in a view.
class Promise {
 public:
  Promise(const std::vector<Camera>& views, const Pose& middle, double medianInverseDepth)
      : position_(middle.position), forward_(glm::normalize(viewAxis(middle))) {
    for (const Camera& view : views)
      field_ = std::max(field_, fieldOf(view.intrinsics) + chord(forward_, viewAxis(view.pose)));
    for (std::size_t d = 0; d < kSampleDepths.size(); ++d) nearness_[d] = kSampleDepths[d] * medianInverseDepth;
  }

  double of(const Photograph& one) const { return most(one.position, 0, one.axis, 0, one.field); }

  // Upper bound for all photographs of a node.
  double of(const TreeNode& node) const {
    const double radius = node.radius * (1 + 1e-9) + 1e-12 * glm::distance(node.centre, position_);
    return most(node.centre, radius, node.axis, node.spread, node.field) * (1 + kMargin) + kMargin;
  }

 private:
  double most(glm::dvec3 centre, double radius, glm::dvec3 axis, double spread, double field) const {
    const glm::dvec3 offset = centre - position_;
    const double along = glm::dot(offset, forward_), across = glm::length(offset - along * forward_);
    const double leastAcross = std::max(0.0, across - radius), leastAlong = std::max(0.0, std::abs(along) - radius);
    double sum = 0;
    for (const double nearness : nearness_) {
      const double ahead = std::clamp(1 - nearness * (along - radius), 0.0, 1.0);  // shows no points behind itself
      if (ahead == 0) continue;
      // The point at this depth as seen from the photograph: D, and the relative error of D at most.
      const glm::dvec3 direction = forward_ - nearness * offset;
      const double length = glm::length(direction), error = nearness * radius;
      double off = 0;
      if (length > error) {
        const double sine = error / length;  // the error's chord is at most sine · (1 + (√2 − 1) sine²)
        off = std::sqrt(std::max(0.0, 2 - 2 * glm::dot(axis, direction) / length)) - spread -
              sine * (1 + (std::numbers::sqrt2 - 1) * sine * sine);
      }
      const double overlap = std::clamp((field + field_ - off) / (2 * field_), 0.0, 1.0);
      if (overlap == 0) continue;
      const double apart = angleOfShift(nearness * leastAcross) + kAlong * angleOfShift(nearness * leastAlong);
      sum += overlap * ahead / std::sqrt(double(shader::kGatherAngleFloor) + apart);
    }
    return sum;
  }

  glm::dvec3 position_, forward_;
  double field_ = 0;  // chord
  std::array<double, kSampleDepths.size()> nearness_{};
};

}  // namespace

PhotographIndex makePhotographIndex(const Scene& scene, std::uint32_t leafSize) {
  PhotographIndex index;
  for (const std::uint32_t b : gatherableBackdrops(scene)) index.photographs.push_back(photographOf(scene, b));
  index.nodes = halvedTree(std::span(index.photographs), leafSize, boundsOf, orderOf);
  return index;
}

std::pmr::vector<Photograph> promisingPhotographs(const PhotographIndex& index, const std::vector<Camera>& views,
                                                  const Pose& middle, double medianInverseDepth, std::size_t most,
                                                  std::pmr::memory_resource* memory) {
  std::pmr::vector<Photograph> found(memory);
  if (index.photographs.size() <= most) {
    found.assign(index.photographs.begin(), index.photographs.end());
  } else {
    // Best first: a node stands for its photographs until it has the greatest promise of all that is left. Rounding to
    // float keeps a node's promise at least as great as those of its photographs.
    constexpr std::uint32_t kPhotograph = 1u << 31;
    struct Open {
      float promise;
      std::uint32_t at;  // index of a node, or of a photograph, with kPhotograph
    };
    const auto isWorse = [&](const Open& a, const Open& b) {
      if (a.promise != b.promise) return a.promise < b.promise;
      if ((a.at & b.at & kPhotograph) == 0) return a.at > b.at;  // nodes first
      return index.photographs[a.at & ~kPhotograph].backdrop > index.photographs[b.at & ~kPhotograph].backdrop;
    };
    const Promise promise(views, middle, medianInverseDepth);
    std::pmr::vector<Open> open(memory);
    const auto put = [&](double promised, std::uint32_t at) {
      open.push_back({float(promised), at});
      std::push_heap(open.begin(), open.end(), isWorse);
    };
    put(0, 0);
    while (found.size() < most) {
      std::pop_heap(open.begin(), open.end(), isWorse);
      const std::uint32_t at = open.back().at;
      open.pop_back();
      if (at & kPhotograph) {
        found.push_back(index.photographs[at & ~kPhotograph]);
        continue;
      }
      const TreeNode& node = index.nodes[at];
      if (node.second != 0) {
        prefetch(index.nodes[node.second]);
        put(promise.of(index.nodes[at + 1]), at + 1);
        put(promise.of(index.nodes[node.second]), node.second);
        continue;
      }
      for (std::uint32_t p = node.first; p < node.end; ++p) put(promise.of(index.photographs[p]), p | kPhotograph);
    }
  }
  std::ranges::sort(found, {}, &Photograph::backdrop);
  return found;
}

}  // namespace ibr
