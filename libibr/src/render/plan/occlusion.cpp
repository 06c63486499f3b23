// SPDX-License-Identifier: Apache-2.0
#include "render/plan/occlusion.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <limits>
#include <vector>

#include "base/prefetch.h"
#include "render/plan/correction.h"
#include "render/plan/cover_mask.h"
#include "render/plan/culling.h"
#include "render/plan/scene_index.h"

namespace ibr {
namespace {

// Cover of the cells drawn so far in one view, and the open rest of the image.
class ViewCover {
 public:
  ViewCover(const FramePlan& plan, std::size_t view, std::pmr::memory_resource* memory)
      : camera_(plan.views[view]),
        mask_(camera_.intrinsics.width, camera_.intrinsics.height, 1.5 * std::max(1.0, 1.0 / plan.settings.renderScale),
              memory),
        open_(memory),
        corners_(memory),
        edges_(memory) {
    findOpen();
  }

  glm::dvec3 eye() const { return camera_.pose.position; }

  bool mayShow(const CellPoses& cell, const CellBounds& bounds, const Placement& placement) const {
    const DirectionBounds directions(cell, bounds, placement, camera_.pose.rotation);
    return std::ranges::any_of(open_, [&](const Opening& part) {
      return !(directions.most({1, 0, part.left}) < 0 || directions.most({-1, 0, -part.right}) < 0 ||
               directions.most({0, 1, part.bottom}) < 0 || directions.most({0, -1, -part.top}) < 0);
    });
  }

  void draw(const CellPoses& cell, const CellBounds& bounds, const Placement& placement) {
    if (bounds.outline.empty() || !isInFront(cell, bounds, placement)) return;
    prefetch(bounds.outline.data(), bounds.outline.size() * sizeof bounds.outline[0]);
    prefetch(bounds.corners.data(), bounds.corners.size() * sizeof bounds.corners[0]);
    if (!projectCorners(cell, bounds, placement)) return;
    edges_.clear();
    for (const CellBounds::OutlineEdge& edge : bounds.outline) {
      const Corner &from = corners_[edge.from], &to = corners_[edge.to];
      const double margin = marginPx(edge, from, to, cell, placement);
      if (!std::isfinite(margin)) return;
      edges_.push_back({from.pixel, to.pixel, margin});
    }
    mask_.add(edges_);
    findOpen();
  }

 private:
  struct Opening {  // an open rectangle, tangents
    double left, right, bottom, top;
  };
  struct Corner {
    glm::dvec2 pixel;
    glm::dvec3 direction;  // D in camera axes
  };

  // Returns false where a corner is not seen at a finite pixel.
  bool projectCorners(const CellPoses& cell, const CellBounds& bounds, const Placement& placement) {
    const auto& [weights, morph, eye, correction] = placement;
    const Intrinsics& k = camera_.intrinsics;
    const glm::dquat rotation = glm::conjugate(camera_.pose.rotation);
    glm::dvec3 shift(0.0);
    std::array<glm::dmat3, 4> toView;
    std::array<std::size_t, 4> shown;  // members with a weight other than 0
    std::size_t count = 0;
    for (std::size_t i = 0; i < cell.count; ++i) {
      if (weights[i] == 0) continue;
      shown[count++] = i;
      const Pose& pose = cell.pose[i];
      toView[i] = weights[i] * glm::mat3_cast(rotation * correction.rotation * glm::normalize(pose.rotation));
      shift += weights[i] * (pose.position - eye);
    }
    shift = rotation * corrected(correction, shift, eye);
    shift_ = morph == Morph::paper ? 0.0 : glm::length(shift);
    corners_.clear();
    for (const CellBounds::Corner& corner : bounds.corners) {
      glm::dvec3 d = morph == Morph::paper ? glm::dvec3(0.0) : double(corner.inverseDistance) * shift;
      for (const std::size_t i : std::span(shown).first(count)) {
        const glm::dvec3 q(corner.point[i]);
        d += toView[i] * (morph == Morph::paper ? glm::normalize(q) : q);
      }
      const glm::dvec2 at(k.cx - k.fx * d.x / d.z, k.cy + k.fy * d.y / d.z);
      if (!(std::abs(at.x) < 1e7 && std::abs(at.y) < 1e7)) return false;
      corners_.push_back({at, d});
    }
    return true;
  }

  // Largest distance in the image of an edge from the chain that it stands for: the chain's D differ by at most r from
  // a point of the edge, whose pixel moves by at most f·r·√(1 + tan²) / (z − r). Infinite where r reaches the eye.
  double marginPx(const CellBounds::OutlineEdge& edge, const Corner& from, const Corner& to, const CellPoses& cell,
                  const Placement& placement) const {
    double r = double(edge.inverseDistanceDeviation) * shift_;
    for (std::size_t i = 0; i < cell.count; ++i) r += std::abs(placement.weights[i]) * double(edge.deviation[i]);
    if (r == 0) return 0;
    const auto tangents = [](glm::dvec3 d) { return glm::abs(glm::dvec2(d) / d.z); };
    const double left = std::min(-from.direction.z, -to.direction.z) - r;
    if (!(left > 0)) return std::numeric_limits<double>::infinity();
    const glm::dvec2 tangent = glm::max(tangents(from.direction), tangents(to.direction));
    const Intrinsics& k = camera_.intrinsics;
    return r / left * std::sqrt(k.fx * k.fx * (1 + tangent.x * tangent.x) + k.fy * k.fy * (1 + tangent.y * tangent.y));
  }

  // True if all vertices are in front of the camera, by their bounding boxes: behind it, a projection is not a map.
  bool isInFront(const CellPoses& cell, const CellBounds& bounds, const Placement& placement) const {
    return DirectionBounds(cell, bounds, placement, camera_.pose.rotation).most({0, 0, 1}) < 0;
  }

  void findOpen() {
    open_.clear();
    mask_.forOpen([&](const CoverMask::Rectangle& part) {
      const Intrinsics& k = camera_.intrinsics;
      open_.push_back({(part.left - k.cx) / k.fx, (part.right - k.cx) / k.fx, (k.cy - part.bottom) / k.fy,
                       (k.cy - part.top) / k.fy});
    });
  }

  const Camera& camera_;
  CoverMask mask_;
  std::pmr::vector<Opening> open_;
  std::pmr::vector<Corner> corners_;  // of the cell that is being drawn
  std::pmr::vector<CoverMask::Edge> edges_;
  double shift_ = 0;  // |t| of that cell: what a deviation of ρ is multiplied by
};

}  // namespace

void markHidden(const Scene& scene, const SceneBounds& bounds, FramePlan& plan, std::pmr::memory_resource* memory) {
  if (plan.cells.empty()) return;
  std::pmr::vector<ViewCover> views(memory);
  views.reserve(plan.views.size());
  for (std::size_t v = 0; v < plan.views.size(); ++v) views.emplace_back(plan, v, memory);
  for (PlannedCell& planned : plan.cells) {  // cells that fade out are drawn too, but hide nothing
    const CellPoses& cell = bounds.index->cells.poses[planned.cell];
    const CellBounds& cellBounds = bounds.cells[planned.cell];
    const auto placementIn = [&](std::size_t v) {
      return Placement{planned.view[v].position, plan.settings.morph, views[v].eye(), planned.correction};
    };
    planned.hidden = true;
    for (std::size_t v = 0; planned.hidden && v < views.size(); ++v)
      planned.hidden = !views[v].mayShow(cell, cellBounds, placementIn(v));
    if (&planned == &plan.cells.back()) break;  // there is nothing behind it
    if (planned.hidden || planned.opacity < 1 || isMasked(scene, scene.cells[planned.cell]))
      continue;  // masks leave holes
    for (std::size_t v = 0; v < views.size(); ++v) views[v].draw(cell, cellBounds, placementIn(v));
  }
}

}  // namespace ibr
